/* What mirrors, glass and rough surfaces do to a path of WAVES wavelengths, for photons and for the eye alike: with
   L/n^2 carried along, both obey the same probabilities.

   Reflection or refraction is drawn by Fresnel's reflectance of the leading wavelength. Where wavelengths part, beyond
   dispersing glass, the bundle is split: the leader carries WAVES times its weight and goes on alone. Reflected they
   stay together. */

typedef struct Bundle {
  scalar weight[WAVES]; /* power, or throughput */
  int hero;             /* the wavelength whose path this is */
  int split;            /* 1: the others are 0 */
} Bundle;

DEVICE void split_bundle(Bundle *b) {
  if (b->split) return;
  for (int w = 0; w < WAVES; ++w) b->weight[w] = w == b->hero ? b->weight[w] * (scalar)WAVES : R(0);
  b->split = 1;
}

/* n of the innermost glass by wavelength. */
DEVICE GLOBAL const scalar *glass_rows(const Looks *looks, int glass) {
  return looks->spectra + looks->materials[(glass & 0xffff) - 1].index * WAVES;
}

/* n of the hero in a glass, or in the medium. */
DEVICE scalar index_in(const Air *air, const Looks *looks, int glass, int hero, scalar height_m) {
  return glass ? glass_rows(looks, glass)[hero] : scalar_root(air_index2(air, hero, height_m));
}

DEVICE int glass_entered(int glass, int material) { return (glass & 0x7fff) << 16 | (material + 1); }

/* What is behind the back of a glass's surface. Surfaces that overlap: the glass that is left need not be the
 * innermost. */
DEVICE int glass_left(int glass, int material) {
  if ((glass & 0xffff) == material + 1) return glass >> 16;
  return glass >> 16 == material + 1 ? glass & 0xffff : glass;
}

/* A path on its way from a light or an eye. glass: as in Path */
DEVICE void begin_path(const Air *air, const Looks *looks, int glass, const Bundle *b, Vec3 place, Vec3 direction,
                       Path *path) {
  path->place = place;
  path->row = b->hero;
  path->glass = glass;
  path->measured = 0;
  path->momentum = times(direction, index_in(air, looks, glass, b->hero, place.z));
}

DEVICE void tint_bundle(Bundle *b, const scalar *by) {
  for (int w = 0; w < WAVES; ++w) b->weight[w] *= by[w];
}

/* A microfacet's normal on the side of `back` (unit, away from the surface, towards where the path came from). */
DEVICE Vec3 facet_normal(Vec3 normal, Vec3 back, scalar roughness, RandomWords words) {
  Vec3 first, second;
  frame_around(normal, &first, &second);
  const Vec3 view = vec3(dot3(back, first), dot3(back, second), dot3(back, normal));
  const Vec3 h = sample_ggx_normal(view, roughness, R(unit_interval(words.word[2])), R(unit_interval(words.word[3])));
  return from_frame(first, second, normal, h);
}

/* Out of a mirror or a conductor. returns: 0 if the path ends (a facet sends it below the surface) */
DEVICE int scatter_reflecting(const Looks *looks, const Material *m, const scalar *tint, Vec3 normal, RandomWords words,
                              Vec3 *direction, Bundle *b) {
  tint_bundle(b, tint);
  if (m->kind == MATERIAL_MIRROR) {
    *direction = mirrored(*direction, normal);
    return 1;
  }
  const Vec3 back = times(*direction, R(-1)), h = facet_normal(normal, back, m->roughness, words);
  const Vec3 out = mirrored(*direction, h);
  const scalar cosine = dot3(out, normal), cosine_in = dot3(back, normal), facing = dot3(back, h);
  if (!(cosine > R(0)) || !(cosine_in > R(0)) || !(facing > R(0))) return 0;
  const scalar masking = ggx_masking_both(cosine_in, cosine, m->roughness) / ggx_masking(cosine_in, m->roughness);
  for (int w = 0; w < WAVES; ++w)
    b->weight[w] *= masking * fresnel_conductor(facing, looks->spectra[m->index * WAVES + w],
                                                looks->spectra[m->extinction * WAVES + w]);
  *direction = out;
  return 1;
}

/* Of a bundle that dispersing glass reflects, whichever wavelength led: the drawn probability is the mean reflectance
   of all of them (balance heuristic of Veach & Guibas, "Optimally combining sampling techniques", SIGGRAPH 1995), so
   that no weight grows by more than WAVES beside the angle of total reflection. */
DEVICE void reflect_bundle(GLOBAL const scalar *glass, int from_outside, scalar index_outside, scalar cosine,
                           Bundle *b) {
  scalar reflected[WAVES], sum = R(0), unused;
  for (int w = 0; w < WAVES; ++w) {
    const scalar over = glass[w] / index_outside;
    reflected[w] = fresnel_dielectric(cosine, from_outside ? over : R(1) / over, &unused);
    sum += reflected[w];
  }
  for (int w = 0; w < WAVES; ++w) b->weight[w] *= reflected[w] * (scalar)WAVES / sum;
}

/* Into or out of glass. index_before, index_beyond: n of the hero on this side and on the other.
   glass: n by wavelength.  returns: 0 if the path ends; *passes: 1 if it goes through */
DEVICE int scatter_glass(const Material *m, GLOBAL const scalar *glass, int from_outside, Vec3 normal,
                         scalar index_before, scalar index_beyond, RandomWords words, Vec3 *direction, Bundle *b,
                         int *passes) {
  const Vec3 back = times(*direction, R(-1));
  const int rough = m->kind == MATERIAL_ROUGH_DIELECTRIC;
  const Vec3 h = rough ? facet_normal(normal, back, m->roughness, words) : normal;
  const scalar cosine = scalar_smaller(dot3(back, h), R(1)), index = index_beyond / index_before;
  if (!(cosine > R(0))) return 0;
  scalar cos_beyond;
  const scalar reflected = fresnel_dielectric(cosine, index, &cos_beyond);
  *passes = !(R(unit_interval(words.word[0])) < reflected);
  if (m->disperses && !b->split) {
    if (*passes) split_bundle(b);
    else reflect_bundle(glass, from_outside, from_outside ? index_before : index_beyond, cosine, b);
  }
  const Vec3 out = unit3(*passes ? refracted(*direction, h, cosine, index, cos_beyond) : mirrored(*direction, h));
  const scalar cosine_out = *passes ? -dot3(out, normal) : dot3(out, normal), cosine_in = dot3(back, normal);
  if (!(cosine_out > R(0)) || !(cosine_in > R(0))) return 0;
  if (rough) {
    const scalar masking =
        *passes ? ggx_masking(cosine_out, m->roughness)
                : ggx_masking_both(cosine_in, cosine_out, m->roughness) / ggx_masking(cosine_in, m->roughness);
    for (int w = 0; w < WAVES; ++w) b->weight[w] *= masking;
  }
  *direction = out;
  return 1;
}

/* A path met a surface that is not Lambert: goes on with a new direction, or ends.
   path: place and momentum are set for the way on;  returns: 0 if it ends */
DEVICE int scatter_specular(const Geometry *g, const Air *air, const Looks *looks, const SurfaceHit *hit,
                            RandomWords words, Path *path, Bundle *b) {
  const Material m = looks->materials[material_of(g, hit->primitive)];
  const scalar index_before = length3(hit->momentum);
  Vec3 direction = times(hit->momentum, R(1) / index_before), normal = smooth_normal(g, hit);
  const int from_outside = dot3(hit->normal, direction) < R(0);
  if (!from_outside) normal = times(normal, R(-1));
  scalar index_after = index_before;
  int passes = 0;
  if (m.kind == MATERIAL_DIELECTRIC || m.kind == MATERIAL_ROUGH_DIELECTRIC) {
    GLOBAL const scalar *glass = looks->spectra + m.index * WAVES;
    const int material = material_of(g, hit->primitive),
              behind = from_outside ? glass_entered(path->glass, material) : glass_left(path->glass, material);
    const scalar beyond = index_in(air, looks, behind, b->hero, hit->place.z);
    if (!scatter_glass(&m, glass, from_outside, normal, index_before, beyond, words, &direction, b, &passes)) return 0;
    if (passes) {
      index_after = beyond;
      path->glass = behind;
    }
  } else {
    scalar tint[WAVES];
    reflectance_at(g, looks, &m, hit, tint);
    if (!scatter_reflecting(looks, &m, tint, normal, words, &direction, b)) return 0;
  }
  /* A smoothed normal may send a path to the wrong side of the surface itself. */
  const scalar side = dot3(hit->normal, direction);
  if ((side < R(0)) == (from_outside ? !passes : passes)) return 0;
  path->place = leave_surface(&g->bounds, hit->place, hit->normal, direction);
  path->momentum = times(direction, index_after);
  return 1;
}

/* Absorption along a way inside glass. */
DEVICE void absorb_in_glass(const Looks *looks, int glass, scalar path_m, Bundle *b) {
  const int absorption = looks->materials[(glass & 0xffff) - 1].absorption;
  if (absorption < 0) return;
  for (int w = 0; w < WAVES; ++w) b->weight[w] *= scalar_exponential(-looks->spectra[absorption * WAVES + w] * path_m);
}
