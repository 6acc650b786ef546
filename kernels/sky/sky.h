/* Light of one direction: the Sun's darkened disk, seen through the transfer table, over the glow of sky or sea. */

#ifdef __OPENCL_C_VERSION__
DEVICE real angle_of(real y, real x) { return atan2(y, x); }
#else
DEVICE real angle_of(real y, real x) {
  for (int i = 0; i < LANES; ++i) LANE(y, i) = std::atan2(LANE(y, i), LANE(x, i));
  return y;
}
#endif

typedef struct SkyDirection {
  real elevation_rad, azimuth_rad; /* azimuth from the picture's centre, clockwise */
} SkyDirection;

/* Directions of places in the picture (pixels, rectilinear projection), a place a lane. */
DEVICE SkyDirection view_direction(const SkyView *v, real column, real row) {
  const real right = (column - v->centre_column) * v->pixel_tangent;
  const real up = (v->centre_row - row) * v->pixel_tangent;
  const real forward = v->cos_altitude - up * v->sin_altitude;
  const real height = v->sin_altitude + up * v->cos_altitude;
  SkyDirection d;
  d.azimuth_rad = angle_of(right, forward);
  d.elevation_rad = angle_of(height, root(forward * forward + right * right));
  return d;
}

/* sin(d/2) of the azimuth d from the Sun. */
DEVICE real sine_half_from_sun(const SkyView *v, real azimuth_rad) {
  return sine(0.5f * (azimuth_rad - v->sun_azimuth_rad));
}

/* Square of the chord 2 sin(d/2) between a point at true altitude sun + from_sun and the Sun's centre. */
DEVICE real chord2_from_sun(const SkyView *v, real from_sun, float half_azimuth) {
  /* cos(a + d) to second order; d is large only where the disk is far. */
  const real cos_there = v->sun_cos_altitude - from_sun * (v->sun_sin_altitude + 0.5f * from_sun * v->sun_cos_altitude);
  const real vertical = from_sun * (1.0f - from_sun * from_sun * (1.0f / 24.0f));
  return vertical * vertical + 4.0f * half_azimuth * half_azimuth * v->sun_cos_altitude * cos_there;
}

/* Limb darkening I(mu)/I(1) = sum A_k mu^k (Neckel & Labs 1994), 0 beyond the limb. */
DEVICE real sun_disk(real chord2, float radius_rad, GLOBAL const float *limb, int waves, int wave) {
  const real mu2 = 1.0f - chord2 * (1.0f / (radius_rad * radius_rad));
  const real mu = root(larger(mu2, SPREAD(0)));
  real sum = SPREAD(0);
  for (int k = LIMB_TERMS - 1; k >= 0; --k) sum = sum * mu + load_lanes(limb + k * waves + wave);
  return mu2 >= R(0) ? sum : SPREAD(0);
}

/* Henyey & Greenstein (1941) phase function over 4 pi, from the chord to the Sun: cos t = 1 - chord^2/2. */
DEVICE real aureole(real chord2, float g) {
  const real denominator = (1.0f - g) * (1.0f - g) + g * chord2;
  return R(0.0795774715) * (1.0f - g * g) / (denominator * root(denominator));
}

/* Radiance of wavelengths wave .. wave + LANES - 1 in a direction, between entries i and i + 1.
   half_azimuth: sine_half_from_sun of it */
DEVICE real sky_radiance(const SkyView *v, GLOBAL const float *table, GLOBAL const float *limb, int waves, int wave,
                         int entry, float fraction, float half_azimuth) {
  GLOBAL const float *here = table + (entry * SKY_CHANNEL_COUNT) * waves + wave;
  GLOBAL const float *next = here + SKY_CHANNEL_COUNT * waves;
  const real joined = load_lanes(here + SKY_JOINED * waves);
  const real beside = SPREAD(fraction) < joined ? SPREAD(0) : SPREAD(1);
  const real f = joined >= R(1) ? SPREAD(fraction) : beside;
  real value[4];
  for (int c = 0; c < 4; ++c) {
    const real a = load_lanes(here + c * waves), b = load_lanes(next + c * waves);
    value[c] = a + f * (b - a);
  }
  const real chord2 = chord2_from_sun(v, value[SKY_FROM_SUN], half_azimuth);
  return value[SKY_SUN] * sun_disk(chord2, v->sun_radius_rad, limb, waves, wave) + value[SKY_GLOW] +
         value[SKY_AUREOLE] * aureole(chord2, v->phase_asymmetry);
}

/* Place of a sample inside its pixel: the R2 sequence (Roberts 2018), shifted by a random number of the pixel. */
DEVICE void sample_place(const SkyView *v, int column, int row, int sample, float *x, float *y) {
  const RandomWords counter = {{(unsigned int)column, (unsigned int)row, 0u, 0u}};
  const RandomWords r = philox(counter, v->seed, 0x536b79u);
  const float a = unit_interval(r.word[0] + 3242174889u * (unsigned int)sample);
  const float b = unit_interval(r.word[1] + 2447445414u * (unsigned int)sample);
  *x = (float)column + a;
  *y = (float)row + b;
}
