/* Photons leaving a light: places and directions of even power. */

/* The primitive of an area light: the first whose running area reaches the fraction. */
DEVICE int pick_primitive(GLOBAL const LightPrimitive *list, int count, scalar fraction) {
  int low = 0, high = count - 1;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (list[middle].running_area > fraction) high = middle;
    else low = middle + 1;
  }
  return list[low].primitive;
}

DEVICE void emit_from_area(const Geometry *g, const Looks *looks, const Light *light, RandomWords place,
                           RandomWords aim, Vec3 *from, Vec3 *direction) {
  const int primitive = pick_primitive(looks->light_primitives + light->first_primitive, light->primitives,
                                       R(unit_interval(place.word[0])));
  const scalar u = R(unit_interval(place.word[1])), v = R(unit_interval(place.word[2]));
  Vec3 normal, on;
  if (primitive < g->bounds.triangles) {
    GLOBAL const SurfaceTriangle *t = g->triangles + primitive;
    scalar second, third;
    sample_triangle(u, v, &second, &third);
    on = place_in_triangle(t, second, third);
    normal = load_vec3(t->normal);
  } else {
    GLOBAL const SurfaceSphere *s = g->spheres + (primitive - g->bounds.triangles);
    normal = sample_cone(u, v, R(2));
    on = along(load_vec3(s->centre), s->radius_m, normal);
  }
  Vec3 first, second;
  frame_around(normal, &first, &second);
  *direction =
      from_frame(first, second, normal, sample_cosine(R(unit_interval(aim.word[0])), R(unit_interval(aim.word[1]))));
  *from = leave_surface(&g->bounds, on, normal, normal);
}

/* What a photon of a darkened disk carries, in place of the disk's mean. u: the word that chose its direction, which is
   the share of the disk that is nearer to the middle, so that mu^2 = 1 - u. The mean over u is 1: nothing is lost. */
DEVICE void darken_limb(const Looks *looks, int limb, scalar u, Bundle *b) {
  if (limb == 0) return;
  const scalar mu = scalar_root(R(1) - u);
  for (int w = 0; w < WAVES; ++w) {
    scalar over_mean = R(0);
    for (int k = LIMB_ROWS - 1; k >= 0; --k) over_mean = over_mean * mu + looks->spectra[(limb + k) * WAVES + w];
    b->weight[w] *= over_mean;
  }
}

DEVICE void emit_photon(const Geometry *g, const Looks *looks, int number, RandomWords place, RandomWords aim,
                        Vec3 *from, Vec3 *direction) {
  const Light light = looks->lights[number];
  if (light.kind == LIGHT_AREA) {
    emit_from_area(g, looks, &light, place, aim, from, direction);
    return;
  }
  const Vec3 axis = vec3(light.direction[0], light.direction[1], light.direction[2]);
  Vec3 first, second;
  frame_around(axis, &first, &second);
  *direction = from_frame(first, second, axis,
                          sample_cone(R(unit_interval(aim.word[0])), R(unit_interval(aim.word[1])), light.versine));
  *from = vec3(light.place[0], light.place[1], light.place[2]);
  if (light.kind != LIGHT_SUN) return;
  const Vec3 disc = sample_disc(R(unit_interval(place.word[0])), R(unit_interval(place.word[1])));
  *from = along(along(*from, light.radius_m * disc.x, first), light.radius_m * disc.y, second);
}
