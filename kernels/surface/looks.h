/* What surfaces and lights look like, by wavelength. WAVES: wavelengths that a photon and an eye path carry. */

#define ROW_WAVE_PLACE 0 /* row of spectra: each wavelength's place in 0..1 for SpectrumCurve */

typedef struct Looks {
  GLOBAL const Material *materials;
  GLOBAL const scalar *spectra; /* [rows][WAVES] */
  GLOBAL const Texture *textures;
  GLOBAL const SpectrumCurve *texels;
  GLOBAL const Light *lights;
  GLOBAL const LightPrimitive *light_primitives;
} Looks;

#define LOOKS_BUFFERS                                                                             \
  GLOBAL const Material *materials, GLOBAL const scalar *spectra, GLOBAL const Texture *textures, \
      GLOBAL const SpectrumCurve *texels, GLOBAL const Light *lights, GLOBAL const LightPrimitive *light_primitives
#define LOOKS_OF_BUFFERS \
  { materials, spectra, textures, texels, lights, light_primitives }

DEVICE int material_of(const Geometry *g, int primitive) {
  return primitive < g->bounds.triangles ? g->triangles[primitive].material
                                         : g->spheres[primitive - g->bounds.triangles].material;
}
DEVICE int light_of(const Geometry *g, int primitive) {
  return primitive < g->bounds.triangles ? g->triangles[primitive].light
                                         : g->spheres[primitive - g->bounds.triangles].light;
}

/* For mirrors and glass: the normals of the corners, weighed; never turned away from the surface's own side so far that
   the path would come from behind it. */
DEVICE Vec3 smooth_normal(const Geometry *g, const SurfaceHit *hit) {
  if (hit->primitive >= g->bounds.triangles) return hit->normal;
  GLOBAL const SurfaceTriangle *t = g->triangles + hit->primitive;
  const Vec3 n = unit3(along(
      along(times(load_vec3(t->corner_normal[0]), R(1) - hit->u - hit->v), hit->u, load_vec3(t->corner_normal[1])),
      hit->v, load_vec3(t->corner_normal[2])));
  const scalar flat = dot3(hit->normal, hit->momentum), smooth = dot3(n, hit->momentum);
  return flat * smooth > R(0) ? n : hit->normal;
}

DEVICE scalar curve_value(SpectrumCurve c, scalar place) {
  const scalar x = (c.c0 * place + c.c1) * place + c.c2;
  return R(0.5) + x / (R(2) * scalar_root(R(1) + x * x));
}

DEVICE int wrapped(int i, int size) {
  const int rest = i % size;
  return rest < 0 ? rest + size : rest;
}

/* Bilinear between the four texels around a place, reflectances rather than coefficients. */
DEVICE void texture_values(const Looks *looks, int number, scalar u, scalar v, scalar *values) {
  const Texture t = looks->textures[number];
  const scalar x = u * (scalar)t.width - R(0.5), y = v * (scalar)t.height - R(0.5);
  const scalar left = scalar_floor(x), below = scalar_floor(y), fx = x - left, fy = y - below;
  const int x0 = wrapped((int)left, t.width), y0 = wrapped((int)below, t.height);
  const int x1 = wrapped(x0 + 1, t.width), y1 = wrapped(y0 + 1, t.height);
  GLOBAL const SpectrumCurve *texel = looks->texels + t.first;
  const SpectrumCurve a = texel[y0 * t.width + x0], b = texel[y0 * t.width + x1];
  const SpectrumCurve c = texel[y1 * t.width + x0], d = texel[y1 * t.width + x1];
  for (int w = 0; w < WAVES; ++w) {
    const scalar place = looks->spectra[ROW_WAVE_PLACE * WAVES + w];
    const scalar low = curve_value(a, place) * (R(1) - fx) + curve_value(b, place) * fx;
    const scalar high = curve_value(c, place) * (R(1) - fx) + curve_value(d, place) * fx;
    values[w] = low * (R(1) - fy) + high * fy;
  }
}

/* Albedo, or tint, at a hit. */
DEVICE void reflectance_at(const Geometry *g, const Looks *looks, const Material *m, const SurfaceHit *hit,
                           scalar *values) {
  if (m->texture >= 0 && hit->primitive < g->bounds.triangles) {
    GLOBAL const SurfaceTriangle *t = g->triangles + hit->primitive;
    const scalar w = R(1) - hit->u - hit->v;
    const scalar u = w * t->texture[0][0] + hit->u * t->texture[1][0] + hit->v * t->texture[2][0];
    const scalar v = w * t->texture[0][1] + hit->u * t->texture[1][1] + hit->v * t->texture[2][1];
    texture_values(looks, m->texture, u, v, values);
    return;
  }
  for (int w = 0; w < WAVES; ++w) values[w] = looks->spectra[m->reflectance * WAVES + w];
}
