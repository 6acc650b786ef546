/* Random numbers of photons, and what is drawn from them: directions, normals, survival. Local frames have z along the
   surface's normal, or along the axis. u, v are in [0, 1). */

#define TWO_PI R(6.28318530717958648)

/* Four words for one decision. Keyed by what is decided, never by who decides or when: any batch, work-group, thread or
   device gets the same. pass: independent repetition; dimension: counts the decisions of one bounce. */
DEVICE RandomWords photon_words(unsigned int seed, unsigned int pass, unsigned int photon, unsigned int bounce,
                                unsigned int dimension) {
  RandomWords counter;
  counter.word[0] = photon;
  counter.word[1] = bounce;
  counter.word[2] = dimension;
  counter.word[3] = pass;
  return philox(counter, seed, 0x50686f74u);
}

/* (cos, sin, 0) of v turns, 0 <= v < 1, good to 9e-8: the quadrant first, which is exact, then fits in Chebyshev
   polynomials over an eighth of a turn either way. The same on every device, and much quicker than a sine that must
   reduce any argument. */
DEVICE Vec3 sample_circle(scalar v) {
  const int quadrant = (int)(R(4) * v + R(0.5));
  const scalar r = v - R(0.25) * (scalar)quadrant, r2 = r * r;
  const scalar sine = r * (R(6.28318528784011) +
                           r2 * (R(-41.34166260181872) + r2 * (R(81.59254820670054) + r2 * R(-75.40184030835883))));
  const scalar cosine =
      R(1) + r2 * (R(-19.739208650244166) +
                   r2 * (R(64.93931617205108) + r2 * (R(-85.44284839440968) + r2 * R(59.22028804138108))));
  const scalar x = quadrant & 1 ? sine : cosine, y = quadrant & 1 ? cosine : sine;
  return vec3((quadrant + 1) & 2 ? -x : x, quadrant & 2 ? -y : y, R(0));
}

/* Evenly on the unit disc, z = 0. */
DEVICE Vec3 sample_disc(scalar u, scalar v) { return times(sample_circle(v), scalar_root(u)); }

/* Density cos(angle)/pi. */
DEVICE Vec3 sample_cosine(scalar u, scalar v) {
  Vec3 d = sample_disc(u, v);
  d.z = scalar_root(R(1) - u);
  return d;
}

/* Evenly within a cone about z. versine: 1 - cos of its half angle, to be computed in double, since a narrow cone is
   nothing but this difference; 2: the whole sphere. */
DEVICE Vec3 sample_cone(scalar u, scalar v, scalar versine) {
  const scalar down = u * versine, sine = scalar_root(down * (R(2) - down));
  const Vec3 round = sample_circle(v);
  return vec3(sine * round.x, sine * round.y, R(1) - down);
}

/* Barycentric coordinates of the second and third corner, evenly over a triangle. */
DEVICE void sample_triangle(scalar u, scalar v, scalar *second, scalar *third) {
  const scalar side = scalar_root(u);
  *second = side * (R(1) - v);
  *third = side * v;
}

/* Out of a local frame. */
DEVICE Vec3 from_frame(Vec3 first, Vec3 second, Vec3 normal, Vec3 inside) {
  return along(along(times(first, inside.x), inside.y, second), inside.z, normal);
}

DEVICE Vec3 mirrored(Vec3 direction, Vec3 normal) { return along(direction, R(-2) * dot3(direction, normal), normal); }

/* Unpolarised Fresnel reflectance at a smooth surface. cosine: of incidence, >= 0; index: n beyond / n before.
   *cos_beyond: cosine of refraction; 0 with total reflection, which returns 1.
   source: Born & Wolf, "Principles of Optics", section 1.5.2 */
DEVICE scalar fresnel_dielectric(scalar cosine, scalar index, scalar *cos_beyond) {
  const scalar sine2_beyond = (R(1) - cosine * cosine) / (index * index);
  *cos_beyond = R(0);
  if (sine2_beyond >= R(1)) return R(1);
  const scalar beyond = scalar_root(R(1) - sine2_beyond);
  const scalar across = (cosine - index * beyond) / (cosine + index * beyond);
  const scalar within = (index * cosine - beyond) / (index * cosine + beyond);
  *cos_beyond = beyond;
  return R(0.5) * (across * across + within * within);
}

/* The same for a conductor of complex index n + i k, from vacuum or air.
   source: Born & Wolf, section 14.2 (13.2 in older editions) */
DEVICE scalar fresnel_conductor(scalar cosine, scalar n, scalar k) {
  const scalar sine2 = R(1) - cosine * cosine, real_part = n * n - k * k - sine2;
  const scalar a2_b2 = scalar_root(real_part * real_part + R(4) * n * n * k * k);
  const scalar a = scalar_root(scalar_larger(R(0), R(0.5) * (a2_b2 + real_part)));
  const scalar t1 = a2_b2 + cosine * cosine, t2 = R(2) * a * cosine;
  const scalar t3 = cosine * cosine * a2_b2 + sine2 * sine2, t4 = t2 * sine2;
  const scalar across = (t1 - t2) / (t1 + t2);
  return R(0.5) * across * (R(1) + (t3 - t4) / (t3 + t4));
}

/* Through the surface; cosine > 0 against the normal on the side it comes from, cos_beyond from fresnel_dielectric. */
DEVICE Vec3 refracted(Vec3 direction, Vec3 normal, scalar cosine, scalar index, scalar cos_beyond) {
  return along(times(direction, R(1) / index), cosine / index - cos_beyond, normal);
}

/* GGX, isotropic roughness alpha: density of microfacet normals [1/sr], Smith's masking of one direction and of two
   (height-correlated).  source: Walter, Marschner, Li, Torrance, "Microfacet models for refraction through rough
   surfaces", EGSR 2007; Heitz, "Understanding the masking-shadowing function", JCGT 3 (2014), eq 99 */
DEVICE scalar ggx_density(scalar cosine, scalar alpha) {
  const scalar a2 = alpha * alpha, d = R(1) + (a2 - R(1)) * cosine * cosine;
  return cosine > R(0) ? R(2) * a2 / (TWO_PI * d * d) : R(0);
}
DEVICE scalar ggx_lambda(scalar cosine, scalar alpha) {
  const scalar tangent2 = (R(1) - cosine * cosine) / (cosine * cosine);
  return R(0.5) * (scalar_root(R(1) + alpha * alpha * tangent2) - R(1));
}
DEVICE scalar ggx_masking(scalar cosine, scalar alpha) { return R(1) / (R(1) + ggx_lambda(cosine, alpha)); }
DEVICE scalar ggx_masking_both(scalar cosine_in, scalar cosine_out, scalar alpha) {
  return R(1) / (R(1) + ggx_lambda(cosine_in, alpha) + ggx_lambda(cosine_out, alpha));
}

/* A microfacet normal with the density visible from `view` (unit, z > 0): G1(view) max(0, view.h) D(h) / view.z.
   A reflection about it has the weight F G2/G1.
   source: Heitz, "Sampling the GGX distribution of visible normals", JCGT 7 (2018) */
DEVICE Vec3 sample_ggx_normal(Vec3 view, scalar alpha, scalar u, scalar v) {
  const Vec3 stretched = unit3(vec3(alpha * view.x, alpha * view.y, view.z));
  const scalar flat = stretched.x * stretched.x + stretched.y * stretched.y;
  const scalar per_flat = flat > R(0) ? R(1) / scalar_root(flat) : R(0);
  const Vec3 first = flat > R(0) ? vec3(-stretched.y * per_flat, stretched.x * per_flat, R(0)) : vec3(R(1), R(0), R(0));
  const Vec3 second = cross3(stretched, first);
  const Vec3 disc = sample_disc(u, v);
  const scalar share = R(0.5) * (R(1) + stretched.z);
  const scalar y = (R(1) - share) * scalar_root(scalar_larger(R(0), R(1) - disc.x * disc.x)) + share * disc.y;
  const scalar z = scalar_root(scalar_larger(R(0), R(1) - disc.x * disc.x - y * y));
  const Vec3 h = from_frame(first, second, stretched, vec3(disc.x, y, z));
  return unit3(vec3(alpha * h.x, alpha * h.y, scalar_larger(R(0), h.z)));
}

/* Russian roulette of a bundle of wavelengths that a surface reflects (or lets pass) in part: it survives with the
   ratio of the largest power after to the largest before, at most 1, and is scaled so that its mean is kept. Survivors
   thus carry about as much as before, which is what keeps the map's noise low. Returns 0 if it is absorbed.
   source: Arvo & Kirk, "Particle transport and image synthesis", SIGGRAPH 1990 */
DEVICE int roulette(scalar *power, const scalar *kept, int waves, scalar u) {
  scalar before = R(0), after = R(0);
  for (int w = 0; w < waves; ++w) {
    before = scalar_larger(before, power[w]);
    after = scalar_larger(after, power[w] * kept[w]);
  }
  const scalar survival = after < before ? after / before : R(1);
  if (!(u < survival)) return 0;
  for (int w = 0; w < waves; ++w) power[w] = power[w] * kept[w] / survival;
  return 1;
}
