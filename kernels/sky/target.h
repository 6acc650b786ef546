/* Targets before the sky: what a ray of sight meets on its way, from the farthest to the nearest. */

typedef struct Targets {
  GLOBAL const float *sight;   /* shared/target.h */
  GLOBAL const Target *rows;   /* farthest first */
  GLOBAL const float *corners; /* [corners][2]: across, up [m] */
  GLOBAL const float *light;
  GLOBAL const TargetTexel *texels;
  GLOBAL const float *crests; /* thresholds by azimuth */
  TargetScale scale;
  int waves;
} Targets;

/* One station as a ray sees it, a wavelength a lane. */
typedef struct StationSight {
  real height_m, passed, airlight, aureole, from_sun, crests;
} StationSight;

DEVICE StationSight station_sight(const Targets *t, int station, int wave, int entry, float fraction) {
  GLOBAL const float *here = t->sight + (entry * t->scale.stations + station) * TARGET_CHANNEL_COUNT * t->waves + wave;
  GLOBAL const float *next = here + t->scale.stations * TARGET_CHANNEL_COUNT * t->waves;
  const real joined = load_lanes(here + TARGET_JOINED * t->waves);
  const real beside = SPREAD(fraction) < joined ? SPREAD(0) : SPREAD(1);
  const real f = joined >= R(1) ? SPREAD(fraction) : beside;
  real value[TARGET_JOINED];
  for (int c = 0; c < TARGET_JOINED; ++c) {
    const real a = load_lanes(here + c * t->waves), b = load_lanes(next + c * t->waves);
    value[c] = a + f * (b - a);
  }
  StationSight s;
  s.height_m = value[TARGET_HEIGHT];
  s.passed = value[TARGET_PASSED];
  s.airlight = value[TARGET_AIRLIGHT];
  s.aureole = value[TARGET_AUREOLE];
  s.from_sun = value[TARGET_FROM_SUN];
  s.crests = value[TARGET_CRESTS];
  return s;
}

/* 1 inside an outline (even-odd rule), 0 outside: how many sides lie straight above. Wavelengths part in height alone,
   so which sides do is the same for all lanes. */
DEVICE real outline_cover(GLOBAL const float *corner, int corners, float across_m, real up_m) {
  mask inside = SPREAD_INT(0);
  GLOBAL const float *from = corner + 2 * (corners - 1);
  for (int k = 0; k < corners; ++k) {
    GLOBAL const float *to = corner + 2 * k;
    if ((from[0] <= across_m) != (to[0] <= across_m)) {
      const float side_m = from[1] + (across_m - from[0]) * ((to[1] - from[1]) / (to[0] - from[0]));
      inside = inside ^ (up_m < SPREAD(side_m));
    }
    from = to;
  }
  return inside ? SPREAD(1) : SPREAD(0);
}

typedef struct TargetLook {
  real cover;
  real shade; /* share of the target's light that comes from there */
} TargetLook;

/* One column or row of texels beside another, and how far between their middles. */
typedef struct TexelPair {
  int low, high;
  float between;
} TexelPair;

DEVICE TexelPair texel_pair(float place, int count) {
  const float from_middle = place * (float)count - 0.5f;
  int low = (int)from_middle;
  if (from_middle < (float)low) low -= 1;
  TexelPair p;
  p.between = from_middle - (float)low;
  p.low = low < 0 ? 0 : (low < count ? low : count - 1);
  p.high = low + 1 < 0 ? 0 : (low + 1 < count ? low + 1 : count - 1);
  return p;
}

/* A picture, bilinear; texels count by what they cover. Outside it covers nothing. */
DEVICE TargetLook picture_look(const Targets *t, GLOBAL const Target *target, int wave, float across_m, real up_m) {
  const float u = (across_m - target->left_m) / (target->right_m - target->left_m);
  const TexelPair columns = texel_pair(u, target->width);
  const real place = load_lanes(t->light + TARGET_LIGHT_PLACE * t->waves + wave);
  TargetLook look;
  look.cover = SPREAD(0);
  look.shade = SPREAD(0);
  for (int k = 0; k < 4; ++k) {
    real c0, c1, c2, weight;
    for (int i = 0; i < LANES; ++i) { /* each wavelength meets the picture at a height of its own */
      const float v = (float)(LANE(up_m, i) - target->bottom_m) / (target->top_m - target->bottom_m);
      const TexelPair rows = texel_pair(v < 0.0f ? 0.0f : (v > 1.0f ? 1.0f : v), target->height);
      const int column = k & 1 ? columns.high : columns.low, row = k & 2 ? rows.high : rows.low;
      const float x = k & 1 ? columns.between : 1.0f - columns.between;
      const float y = k & 2 ? rows.between : 1.0f - rows.between;
      const TargetTexel texel = t->texels[target->first + row * target->width + column];
      LANE(c0, i) = texel.c0;
      LANE(c1, i) = texel.c1;
      LANE(c2, i) = texel.c2;
      LANE(weight, i) = x * y * texel.alpha;
    }
    const real x = (c0 * place + c1) * place + c2;
    look.cover += weight;
    look.shade += weight * (R(0.5) + R(0.5) * x / root(R(1) + x * x));
  }
  look.shade = look.cover > R(0) ? look.shade / look.cover : SPREAD(0);
  return look;
}

/* What a target shows at a ray's azimuth and height. */
DEVICE TargetLook target_look(const Targets *t, GLOBAL const Target *target, int wave, float across_m, real up_m) {
  const mask above_ground = up_m >= R(0); /* others ended before */
  const mask within = above_ground & (up_m >= target->bottom_m) & (up_m < target->top_m);
  TargetLook look;
  look.cover = SPREAD(0);
  look.shade = SPREAD(1);
  if (!any_lane(within)) return look;
  if (target->corners > 0) look.cover = outline_cover(t->corners + 2 * target->first, target->corners, across_m, up_m);
  else look = picture_look(t, target, wave, across_m, up_m);
  look.cover = within ? look.cover : SPREAD(0);
  return look;
}

DEVICE int target_spans(GLOBAL const Target *target, float azimuth_rad, float *across_m) {
  *across_m = (azimuth_rad - target->azimuth_rad) * target->metres_per_rad;
  return *across_m >= target->left_m && *across_m < target->right_m;
}

/* How many crests in the way, on average, hide a ray at this azimuth. */
DEVICE float crest_threshold(const Targets *t, float azimuth_rad) {
  if (t->scale.crests == 0) return 1e30f;
  const float at = (azimuth_rad - t->scale.first_crest_rad) * t->scale.crests_per_rad;
  const float last = (float)(t->scale.crests - 2);
  const float inside = at < 0.0f ? 0.0f : (at > last ? last : at);
  const int low = (int)inside;
  return t->crests[low] + (inside - (float)low) * (t->crests[low + 1] - t->crests[low]);
}

/* Light of a path up to a target, and of the target through it. */
DEVICE real light_of_target(const SkyView *v, const StationSight *s, real radiance, float half_azimuth) {
  const real chord2 = chord2_from_sun(v, s->from_sun, half_azimuth);
  return radiance * s->passed + s->airlight + s->aureole * aureole(chord2, v->phase_asymmetry);
}

/* Whether waves hide anything of a ray of sight at some wavelength. */
DEVICE int waves_hide(const Targets *t, int wave, int entry, float fraction, float azimuth_rad) {
  if (t->scale.crests == 0) return 0;
  const StationSight sight = station_sight(t, t->scale.stations - 1, wave, entry, fraction);
  return any_lane(sight.crests > crest_threshold(t, azimuth_rad));
}

/* The radiance of a ray of sight, given that of what lies behind targets and waves, and that of the sea, which counts
   where waves hide the ray. */
DEVICE real before_targets(const SkyView *v, const Targets *t, real behind, real sea, int wave, int entry,
                           float fraction, float azimuth_rad, float half_azimuth) {
  real radiance = behind;
  const float threshold = crest_threshold(t, azimuth_rad);
  int station = t->scale.crests > 0 ? t->scale.stations - 1 : -1;
  StationSight sight;
  if (station >= 0) {
    sight = station_sight(t, station, wave, entry, fraction);
    radiance = sight.crests > threshold ? sea : radiance;
  }
  for (int k = 0; k < t->scale.targets; ++k) {
    GLOBAL const Target *target = t->rows + k;
    float across_m;
    if (!target_spans(target, azimuth_rad, &across_m)) continue;
    if (target->station != station) sight = station_sight(t, target->station, wave, entry, fraction);
    station = target->station;
    TargetLook look = target_look(t, target, wave, across_m, sight.height_m);
    look.cover = sight.crests > threshold ? SPREAD(0) : look.cover;
    if (!any_lane(look.cover > R(0))) continue;
    const real white = load_lanes(t->light + (TARGET_LIGHT_FIRST + k) * t->waves + wave);
    const real seen = light_of_target(v, &sight, look.shade * white, half_azimuth);
    radiance += look.cover * (seen - radiance);
  }
  return radiance;
}

#if LANES == 1
typedef struct TargetHit {
  int target; /* row, or -1 */
  real height_m;
} TargetHit;

/* The nearest target of which a ray of sight meets at least half: for the channels beside a picture. */
DEVICE TargetHit nearest_target(const Targets *t, int wave, int entry, float fraction, float azimuth_rad) {
  TargetHit hit;
  hit.target = -1;
  hit.height_m = R(0);
  for (int k = t->scale.targets - 1; k >= 0 && hit.target < 0; --k) {
    GLOBAL const Target *target = t->rows + k;
    float across_m;
    if (!target_spans(target, azimuth_rad, &across_m)) continue;
    const StationSight sight = station_sight(t, target->station, wave, entry, fraction);
    const TargetLook look = target_look(t, target, wave, across_m, sight.height_m);
    if (look.cover < R(0.5) || sight.crests > crest_threshold(t, azimuth_rad)) continue;
    hit.target = k;
    hit.height_m = sight.height_m;
  }
  return hit;
}
#endif
