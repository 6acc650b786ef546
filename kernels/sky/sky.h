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
  real cos_there, vertical;
  if (v->azimuths == 0) { /* near the disk alone: cos(a + d) to second order */
    cos_there = v->sun_cos_altitude - from_sun * (v->sun_sin_altitude + 0.5f * from_sun * v->sun_cos_altitude);
    vertical = from_sun * (1.0f - from_sun * from_sun * (1.0f / 24.0f));
  } else { /* sin d, cos d, 2 sin(d/2) by their series, which keep the smallest d: errors 6e-5 at 1, 2e-3 at pi/2 */
    const real d2 = from_sun * from_sun;
    const real sine_d =
        from_sun * (1.0f - d2 * (1.0f / 6.0f) * (1.0f - d2 * (1.0f / 20.0f) * (1.0f - d2 * (1.0f / 42.0f))));
    const real cosine_d = 1.0f - 0.5f * d2 * (1.0f - d2 * (1.0f / 12.0f) * (1.0f - d2 * (1.0f / 30.0f)));
    cos_there = v->sun_cos_altitude * cosine_d - v->sun_sin_altitude * sine_d;
    vertical = from_sun * (1.0f - d2 * (1.0f / 24.0f) * (1.0f - d2 * (1.0f / 80.0f)));
  }
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

/* Fresnel's reflectance of water (1.34), unpolarised, by the cosine of the angle of incidence. */
DEVICE real water_reflectance(real cosine) {
  const real inside = root(1.0f - (1.0f - cosine * cosine) * (1.0f / (1.34f * 1.34f)));
  const real across = (cosine - 1.34f * inside) / (cosine + 1.34f * inside);
  const real along = (1.34f * cosine - inside) / (1.34f * cosine + inside);
  return 0.5f * (across * across + along * along);
}

/* The Sun mirrored by waves (Cox & Munk 1954): the one slope that does it, its density over pi slope2, and its tilt.
   grazing, sun: sines of the angles above the sea's horizontal */
DEVICE real glitter(const SkyView *v, real grazing, real sun, float half_azimuth) {
  const real view_level = root(1.0f - grazing * grazing), sun_level = root(1.0f - sun * sun);
  const real apart = sun_level - view_level;
  const real level2 = apart * apart + 4.0f * half_azimuth * half_azimuth * view_level * sun_level;
  const real up = larger(grazing + sun, SPREAD(1e-6f)), up2 = up * up, length2 = level2 + up2;
  const real tilt = length2 / up2; /* 1/cos^2 */
  const real density = exponential((1.0f - tilt) * (1.0f / v->slope2)) * (0.318309886f / v->slope2);
  return water_reflectance(0.5f * root(length2)) * density * tilt * tilt;
}

/* What all wavelengths of one direction share. */
typedef struct SkySample {
  int entry; /* of the table; the direction lies between it and the next one, */
  float fraction;
  float azimuth_rad, half_azimuth; /* from the picture's centre; sine_half_from_sun of it */
  float glitter;                   /* radiance of the sea that mirrors the Sun, over row SKY_GLITTER */
  float weight[SKY_MOST_AZIMUTHS];
} SkySample;

/* Weights of the azimuths at x = -1..1: Lagrange's polynomials over Chebyshev's extreme points, in the barycentric form
   (Berrut & Trefethen 2004, eq 5.4). */
DEVICE void azimuth_weights(const SkyView *v, float half_azimuth, float *weight) {
  const float place = (half_azimuth * half_azimuth - v->azimuth_middle) * v->azimuth_per_half;
  const float x = place < -1.0f ? -1.0f : place > 1.0f ? 1.0f : place;
  if (v->azimuths == 1) {
    weight[0] = 1.0f;
    return;
  }
  if (v->azimuths == 2) {
    weight[0] = 0.5f - 0.5f * x, weight[1] = 0.5f + 0.5f * x;
    return;
  }
  float sum = 0.0f;
  int at = -1;
  for (int m = 0; m < v->azimuths; ++m) {
    const float away = x - v->azimuth_places[m];
    if (away == 0.0f) at = m;
    const float end = m == 0 || m == v->azimuths - 1 ? 0.5f : 1.0f;
    weight[m] = (m & 1 ? -end : end) / (away == 0.0f ? 1.0f : away);
    sum += weight[m];
  }
  for (int m = 0; m < v->azimuths; ++m) weight[m] = at < 0 ? weight[m] / sum : m == at ? 1.0f : 0.0f;
}

/* Between two of a table's values, or the one that is not 0: beyond the horizon there is no sea. */
DEVICE float between_seas(float here, float next, float fraction) {
  return here > 0.0f && next > 0.0f ? here + fraction * (next - here) : here > 0.0f ? here : next;
}

DEVICE SkySample sky_sample(const SkyView *v, GLOBAL const float *table, int waves, int entry, float fraction,
                            float azimuth_rad, float half_azimuth) {
  SkySample s;
  s.entry = entry, s.fraction = fraction, s.azimuth_rad = azimuth_rad, s.half_azimuth = half_azimuth;
  s.glitter = 0.0f;
  azimuth_weights(v, half_azimuth, s.weight);
  if (v->slope2 <= 0.0f) return s;
  const int channels = SKY_LIGHT + 2 * v->azimuths;
  GLOBAL const float *here = table + (entry * channels + SKY_GRAZING) * waves, *next = here + channels * waves;
  const float grazing = between_seas(here[0], next[0], fraction);
  if (grazing <= 0.0f) return s;
  const float sun = between_seas(here[waves], next[waves], fraction);
  const real shine = glitter(v, SPREAD(grazing), SPREAD(sun), half_azimuth);
  s.glitter = (float)LANE(shine, 0);
  return s;
}

/* The Moon by Lommel & Seeliger's law, in the Earth's shadow where it is eclipsed. from_sun: altitude of the direction
   minus that of the Sun [rad]. Radiance outside the air; -1 beside the disk. */
DEVICE real moon_disk(const SkyView *v, real from_sun, float azimuth_rad, GLOBAL const float *disks, int waves,
                      int wave) {
  const MoonView *m = &v->moon;
  const real aside = SPREAD(azimuth_rad - m->azimuth_rad);
  const real right = sine(aside) * (m->cos_altitude / m->radius_rad);
  const real up = (from_sun - m->above_sun) * (1.0f / m->radius_rad);
  const real towards2 = 1.0f - right * right - up * up;
  const mask on = (towards2 >= R(0)) & (cosine(aside) > R(0));
  if (!any_lane(on)) return SPREAD(-1);
  const real towards = root(larger(towards2, SPREAD(1e-12f)));
  const real lit = larger(right * m->sun_right + up * m->sun_up + towards * m->sun_towards, SPREAD(0));
  real radiance = load_lanes(disks + DISK_MOON * waves + wave) * (2.0f * lit / (lit + towards));
  if (m->shadow_rows > 0) {
    const real x = right - m->shadow_right, y = up - m->shadow_up;
    const real row = smaller(root(x * x + y * y) * m->shadow_rows_per_radius, SPREAD((float)(m->shadow_rows - 1)));
    GLOBAL const float *shadow = disks + DISK_MOON_SHADOW * waves + wave;
    for (int i = 0; i < LANES; ++i) { /* each wavelength sees the disk a little higher or lower */
      const float at = (float)LANE(row, i);
      const int below = (int)at < m->shadow_rows - 2 ? (int)at : m->shadow_rows - 2;
      const float a = shadow[below * waves + i], b = shadow[(below + 1) * waves + i];
      LANE(radiance, i) *= a + (at - (float)below) * (b - a);
    }
  }
  return on ? radiance : SPREAD(-1);
}

/* Radiance of wavelengths wave .. wave + LANES - 1 in a direction. disks: shared/sky.h */
DEVICE real sky_radiance(const SkyView *v, GLOBAL const float *table, GLOBAL const float *disks, int waves, int wave,
                         const SkySample *s) {
  const int channels = SKY_LIGHT + 2 * v->azimuths;
  GLOBAL const float *here = table + (s->entry * channels) * waves + wave;
  GLOBAL const float *next = here + channels * waves;
  const real joined = load_lanes(here + SKY_JOINED * waves);
  const real beside = SPREAD(s->fraction) < joined ? SPREAD(0) : SPREAD(1);
  const real f = joined >= R(1) ? SPREAD(s->fraction) : beside;
  real value[2];
  for (int c = 0; c < 2; ++c) {
    const real a = load_lanes(here + c * waves), b = load_lanes(next + c * waves);
    value[c] = a + f * (b - a);
  }
  const real chord2 = chord2_from_sun(v, value[SKY_FROM_SUN], s->half_azimuth);
  real disk = sun_disk(chord2, v->sun_radius_rad, disks, waves, wave);
  if (v->moon.radius_rad > 0.0f) { /* the Moon covers the Sun */
    const real moon = moon_disk(v, value[SKY_FROM_SUN], s->azimuth_rad, disks, waves, wave);
    disk = moon >= R(0) ? moon : disk;
  }
  real radiance = value[SKY_PASSED] * disk;
  if (v->azimuths == 0) return radiance;
  real light[2][2]; /* this entry's and the next one's glow and aureole at this azimuth */
  for (int c = 0; c < 2; ++c) light[0][c] = light[1][c] = SPREAD(0);
  for (int m = 0; m < v->azimuths; ++m) {
    const int row = (SKY_LIGHT + 2 * m) * waves;
    for (int c = 0; c < 2; ++c) {
      light[0][c] += s->weight[m] * load_lanes(here + row + c * waves);
      light[1][c] += s->weight[m] * load_lanes(next + row + c * waves);
    }
  }
  const real glow = light[0][SKY_GLOW] + f * (light[1][SKY_GLOW] - light[0][SKY_GLOW]);
  const real haze = light[0][SKY_AUREOLE] + f * (light[1][SKY_AUREOLE] - light[0][SKY_AUREOLE]);
  radiance += larger(glow, SPREAD(0)) + haze * aureole(chord2, v->phase_asymmetry);
  if (s->glitter > 0.0f) {
    const real a = load_lanes(here + SKY_GLITTER * waves), b = load_lanes(next + SKY_GLITTER * waves);
    radiance += (a + f * (b - a)) * s->glitter;
  }
  return radiance;
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
