/* The samplers by number, for tests of their distributions on host and device. */

enum SampleKind {
  SAMPLE_DISC = 0,
  SAMPLE_COSINE = 1,
  SAMPLE_CONE = 2,     /* parameter: versine */
  SAMPLE_TRIANGLE = 3, /* x, y: barycentric */
  SAMPLE_GGX = 4,      /* parameter: alpha; seen from 60 degrees off the normal */
  SAMPLE_ROULETTE = 5  /* parameter: what is kept of the first wavelength, half of it of the second; x, y: powers */
};

DEVICE Vec3 sample_of_kind(int kind, scalar parameter, RandomWords words) {
  const scalar u = R(unit_interval(words.word[0])), v = R(unit_interval(words.word[1]));
  if (kind == SAMPLE_DISC) return sample_disc(u, v);
  if (kind == SAMPLE_COSINE) return sample_cosine(u, v);
  if (kind == SAMPLE_CONE) return sample_cone(u, v, parameter);
  if (kind == SAMPLE_GGX) return sample_ggx_normal(vec3(R(0.8660254037844386), R(0), R(0.5)), parameter, u, v);
  Vec3 out = vec3(R(0), R(0), R(0));
  if (kind == SAMPLE_TRIANGLE) sample_triangle(u, v, &out.x, &out.y);
  if (kind == SAMPLE_ROULETTE) {
    scalar power[2] = {R(1), R(1)};
    const scalar kept[2] = {parameter, R(0.5) * parameter};
    if (roulette(power, kept, 2, u)) out.x = power[0], out.y = power[1];
  }
  return out;
}
