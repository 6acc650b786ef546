/* Terrain as an eye sees it: heights over azimuth and distance, and where rays of sight pass above them.

   Along a ray's azimuth the ground is a row of samples, straight between them. Samples come in blocks; within one a ray
   is straight, too. Rays are known at nodes of elevation, not evenly spaced, between which their heights are linear
   (render/terrain_sights.hpp).

   heights  [columns][samples]   above the surface [m]; 0: sea
   slopes   [columns][samples][2]   rise over run away from the eye and to the right, times TERRAIN_SLOPE_ONE
   tops     [columns][blocks]    highest sample of a block
   rays     [nodes][blocks + 1][waves]   heights where blocks begin; waves: 1 where one serves all
   grounded [nodes][waves]       1: the ray ends at the surface of the sea
   masks    [columns - 1][nodes - 1][words]   blocks in which a ray between two nodes and two columns may meet
   something, 32 to a word, the highest bit first light    [nodes][light stations][TERRAIN_CHANNEL_COUNT][SKY_WAVES]
   shine    [2][SKY_WAVES]       radiance of ground that faces the Sun, and of ground in the light of the sky alone */

#define TERRAIN_SLOPE_ONE 8192.0f

enum TerrainChannel {
  TERRAIN_PASSED = 0, /* as TARGET_PASSED and its followers */
  TERRAIN_AIRLIGHT = 1,
  TERRAIN_AUREOLE = 2,
  TERRAIN_FROM_SUN = 3,
  TERRAIN_CHANNEL_COUNT = 4
};

/* Samples first .. first + count at from_m, from_m + step_m, ..; its last is the next block's first. One more than
   there are blocks: where the last one ends. */
typedef struct TerrainBlock {
  float from_m, step_m;
  int first, count;
} TerrainBlock;

typedef struct TerrainScale {
  int columns, samples, blocks, words, nodes;
  int waves;            /* of rays */
  int blocks_per_light; /* light stations stand at every so many blocks */
  int light_stations;
  float first_azimuth_rad, columns_per_rad;
  float sun_sin_altitude, sun_cos_altitude, sun_azimuth_rad; /* at the eye; azimuth from the picture's centre */
  float curvature_per_m;                                     /* of the surface */
  float sea_horizon_m;                                       /* waves hide what stands farther away */
  int pad_;
} TerrainScale;
