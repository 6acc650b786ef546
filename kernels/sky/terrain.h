/* Terrain before the sky: the first place at which a bent ray of sight meets it. */

#ifdef __OPENCL_C_VERSION__
DEVICE int leading_zeros(unsigned int bits) { return (int)clz(bits); }
#else
DEVICE int leading_zeros(unsigned int bits) { return bits ? __builtin_clz(bits) : 32; }
#endif

typedef struct Terrain {
  GLOBAL const float *heights;
  GLOBAL const short *slopes;
  GLOBAL const float *tops;
  GLOBAL const TerrainBlock *blocks;
  GLOBAL const float *node_entry; /* place of each node among the entries of the transfer table */
  GLOBAL const int *first_node;   /* of each entry: the last node at or before it */
  GLOBAL const float *rays;
  GLOBAL const float *grounded;
  GLOBAL const unsigned int *masks;
  GLOBAL const float *light;
  GLOBAL const float *shine;
  TerrainScale scale;
  int sky_waves;
} Terrain;

/* Where a ray of sight is among nodes and columns. */
typedef struct TerrainSight {
  int node, column;
  float above_node, right_of_column; /* 0..1 */
  float azimuth_rad;
} TerrainSight;

/* A wavelength a lane. */
typedef struct TerrainHit {
  real distance_m; /* 0: none */
  real height_m;
  real facing; /* cosine of the angle at which the Sun shines on the ground */
  mask block;
} TerrainHit;

DEVICE TerrainSight terrain_sight(const Terrain *t, float entry, float azimuth_rad) {
  TerrainSight s;
  s.node = t->first_node[(int)entry];
  while (s.node + 2 < t->scale.nodes && t->node_entry[s.node + 1] <= entry) s.node += 1;
  const float low = t->node_entry[s.node], high = t->node_entry[s.node + 1];
  const float f = high > low ? (entry - low) / (high - low) : 0.0f;
  s.above_node = f < 0.0f ? 0.0f : (f > 1.0f ? 1.0f : f);
  const float last = (float)(t->scale.columns - 1);
  float at = (azimuth_rad - t->scale.first_azimuth_rad) * t->scale.columns_per_rad;
  at = at < 0.0f ? 0.0f : (at > last ? last : at);
  s.column = (int)at < t->scale.columns - 2 ? (int)at : t->scale.columns - 2;
  s.right_of_column = at - (float)s.column;
  s.azimuth_rad = azimuth_rad;
  return s;
}

DEVICE real ray_at_block(const Terrain *t, const TerrainSight *s, int wave, int block) {
  const int next = (t->scale.blocks + 1) * t->scale.waves;
  GLOBAL const float *here = t->rays + (s->node * (t->scale.blocks + 1) + block) * t->scale.waves;
  if (t->scale.waves == 1) return SPREAD(here[0] + s->above_node * (here[next] - here[0]));
  const real a = load_lanes(here + wave), b = load_lanes(here + next + wave);
  return a + s->above_node * (b - a);
}

DEVICE mask ray_is_grounded(const Terrain *t, const TerrainSight *s, int wave) {
  GLOBAL const float *at = t->grounded + (s->node + (s->above_node < 0.5f ? 0 : 1)) * t->scale.waves;
  const real ends = t->scale.waves == 1 ? SPREAD(at[0]) : load_lanes(at + wave);
  return ends > R(0.5);
}

DEVICE float between_columns(const Terrain *t, const TerrainSight *s, int sample) {
  const float a = t->heights[s->column * t->scale.samples + sample];
  const float b = t->heights[(s->column + 1) * t->scale.samples + sample];
  return a + s->right_of_column * (b - a);
}

/* Cosine of the angle between the Sun and the ground's normal; 0 on the side away from it, and where it has set.
   along, across: slopes away from the eye and to the right */
DEVICE float facing_the_sun(const TerrainScale *t, float along, float across, float azimuth_rad, float distance_m) {
  const float aside = t->sun_azimuth_rad - azimuth_rad, angle = distance_m * t->curvature_per_m;
#ifdef __OPENCL_C_VERSION__
  const float forward = t->sun_cos_altitude * cos(aside), right = t->sun_cos_altitude * sin(aside);
  const float tilt = sin(angle), length = sqrt(1.0f + along * along + across * across);
#else
  const float forward = t->sun_cos_altitude * std::cos(aside), right = t->sun_cos_altitude * std::sin(aside);
  const float tilt = std::sin(angle), length = std::sqrt(1.0f + along * along + across * across);
#endif
  const float level = 1.0f - 0.5f * tilt * tilt; /* the vertical there is turned by the Earth's angle */
  const float forward_there = forward * level - t->sun_sin_altitude * tilt;
  const float up_there = t->sun_sin_altitude * level + forward * tilt;
  const float cosine = (up_there - along * forward_there - across * right) / length;
  return up_there > 0.0f && cosine > 0.0f ? cosine : 0.0f;
}

DEVICE float slope_between(const Terrain *t, const TerrainSight *s, int sample, float way, int which) {
  GLOBAL const short *a = t->slopes + 2 * (s->column * t->scale.samples + sample) + which;
  GLOBAL const short *b = a + 2 * t->scale.samples;
  const float left = (float)a[0] + way * (float)(a[2] - a[0]), right = (float)b[0] + way * (float)(b[2] - b[0]);
  return (left + s->right_of_column * (right - left)) / TERRAIN_SLOPE_ONE;
}

/* Looks through the samples of a block. open: lanes still on their way; at_from, at_end: their heights where it begins
   and where it ends. */
DEVICE void search_block(const Terrain *t, const TerrainSight *s, int block, real at_from, real at_end, mask grounded,
                         mask *open, TerrainHit *hit) {
  const TerrainBlock b = t->blocks[block];
  const real rise = (at_end - at_from) * (1.0f / (float)b.count);
  float ground = between_columns(t, s, b.first);
  real before = at_from - (ground > 0.0f ? ground : 0.0f), height = at_from;
  for (int m = 1; m <= b.count; ++m) {
    const float last_ground = ground;
    ground = between_columns(t, s, b.first + m);
    height = at_from + rise * (float)m;
    const real gap = height - (ground > 0.0f ? ground : 0.0f);
    const mask crossed = *open & (gap <= R(0));
    if (any_lane(crossed)) {
      const real fallen = before - gap;
      const mask above = (before > R(0)) & (fallen > R(0));
      const real share = above ? before / fallen : SPREAD(0);
      const mask lands = crossed & (last_ground + share * (ground - last_ground) > R(0));
      const real distance = b.from_m + (share + (float)(m - 1)) * b.step_m;
      hit->distance_m = lands ? distance : hit->distance_m;
      hit->height_m = lands ? height - rise * (R(1) - share) : hit->height_m;
      hit->block = lands ? SPREAD_INT(block) : hit->block;
      for (int i = 0; i < LANES; ++i)
        if (LANE_INT(lands, i)) {
          const float way = (float)LANE(share, i);
          LANE(hit->facing, i) =
              facing_the_sun(&t->scale, slope_between(t, s, b.first + m - 1, way, 0),
                             slope_between(t, s, b.first + m - 1, way, 1), s->azimuth_rad, (float)LANE(distance, i));
        }
      const mask ends = lands | (crossed & grounded);
      *open = ends ? SPREAD_INT(0) : *open;
      if (!any_lane(*open)) return;
    }
    before = gap;
  }
}

DEVICE TerrainHit first_terrain(const Terrain *t, const TerrainSight *s, int wave) {
  TerrainHit hit;
  hit.distance_m = hit.height_m = hit.facing = SPREAD(0);
  hit.block = SPREAD_INT(0);
  const mask grounded = ray_is_grounded(t, s, wave);
  mask open = SPREAD(0) == SPREAD(0);
  GLOBAL const unsigned int *words = t->masks + (s->column * (t->scale.nodes - 1) + s->node) * t->scale.words;
  for (int w = 0; w < t->scale.words; ++w) {
    unsigned int bits = words[w];
    while (bits != 0) {
      const int bit = leading_zeros(bits), block = 32 * w + bit;
      bits &= ~(0x80000000u >> bit);
      GLOBAL const float *top = t->tops + s->column * t->scale.blocks + block;
      const float highest = top[0] > top[t->scale.blocks] ? top[0] : top[t->scale.blocks];
      const real from = ray_at_block(t, s, wave, block), end = ray_at_block(t, s, wave, block + 1);
      if (!any_lane(open & (smaller(from, end) <= (highest > 0.0f ? highest : 0.0f)))) continue;
      search_block(t, s, block, from, end, grounded, &open, &hit);
      if (!any_lane(open)) return hit;
    }
  }
  return hit;
}

/* Light of the ground where it was met, and of the air before it; elsewhere what lies behind. */
DEVICE real light_of_terrain(const SkyView *v, const Terrain *t, const TerrainSight *s, const TerrainHit *hit,
                             real behind, int wave, float half_azimuth) {
  real radiance = behind;
  mask left = hit->distance_m > R(0);
  const int rows = TERRAIN_CHANNEL_COUNT * t->sky_waves, next_node = t->scale.light_stations * rows;
  const real ground = load_lanes(t->shine + wave) * hit->facing + load_lanes(t->shine + t->sky_waves + wave);
  while (any_lane(left)) {
    int lane = 0;
    while (!LANE_INT(left, lane)) ++lane;
    int station = LANE_INT(hit->block, lane) / t->scale.blocks_per_light;
    const int from_block = station * t->scale.blocks_per_light;
    const int end_block = from_block + t->scale.blocks_per_light < t->scale.blocks
                              ? from_block + t->scale.blocks_per_light
                              : t->scale.blocks;
    const mask same = left & (hit->block >= SPREAD_INT(from_block)) & (hit->block < SPREAD_INT(end_block));
    const float from_m = t->blocks[from_block].from_m, end_m = t->blocks[end_block].from_m;
    const real f = (hit->distance_m - from_m) * (1.0f / (end_m - from_m));
    GLOBAL const float *here = t->light + (s->node * t->scale.light_stations + station) * rows + wave;
    real value[TERRAIN_CHANNEL_COUNT];
    for (int c = 0; c < TERRAIN_CHANNEL_COUNT; ++c) {
      GLOBAL const float *at = here + c * t->sky_waves;
      const real a = load_lanes(at), b = load_lanes(at + next_node), far_a = load_lanes(at + rows);
      const real far_b = load_lanes(at + next_node + rows);
      const real near_ = a + s->above_node * (b - a);
      value[c] = near_ + f * (far_a + s->above_node * (far_b - far_a) - near_);
    }
    const real chord2 = chord2_from_sun(v, value[TERRAIN_FROM_SUN], half_azimuth);
    const real seen = ground * value[TERRAIN_PASSED] + value[TERRAIN_AIRLIGHT] +
                      value[TERRAIN_AUREOLE] * aureole(chord2, v->phase_asymmetry);
    radiance = same ? seen : radiance;
    left = same ? SPREAD_INT(0) : left;
  }
  return radiance;
}
