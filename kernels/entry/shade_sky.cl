/* One work-item adds some samples of one pixel to its spectrum, and their sum over wavelengths and its square for the
   noise. The first samples replace what lies there. */
#include "lib/language.h"
#include "lib/random.h"
#include "shared/sky.h"
#include "sky/sky.h"

#if defined(WITH_TARGETS)
#include "shared/target.h"
#include "sky/target.h"
#endif

#if defined(WITH_TERRAIN) /* and with targets, of which there may be none */
#include "shared/terrain.h"
#include "sky/terrain.h"
#endif

__kernel void shade_sky(__global const float *table, __global const float *disks, __global float *spectra,
                        __global float *moments, const SkyView view
#if defined(WITH_TARGETS)
                        ,
                        __global const float *sight, __global const Target *target_rows, __global const float *corners,
                        __global const float *target_light, __global const TargetTexel *texels,
                        __global const float *crests, const TargetScale scale
#endif
#if defined(WITH_TERRAIN)
                        ,
                        __global const float *heights, __global const short *slopes, __global const float *tops,
                        __global const TerrainBlock *blocks, __global const float *node_entry,
                        __global const int *first_node, __global const float *rays, __global const float *grounded,
                        __global const uint *masks, __global const float *terrain_light, __global const float *shine,
                        const TerrainScale terrain_scale
#endif
) {
  const int pixel = (int)get_global_id(0);
  if (pixel >= view.width * view.rows) return;
  const int column = view.first_column + pixel % view.width, row = view.first_row + pixel / view.width;
  const int waves = SKY_WAVES;
#if defined(WITH_TARGETS)
  const Targets targets = {sight, target_rows, corners, target_light, texels, crests, scale, SKY_WAVES};
#endif
#if defined(WITH_TERRAIN)
  const Terrain terrain = {heights,  slopes, tops,          blocks, node_entry,    first_node, rays,
                           grounded, masks,  terrain_light, shine,  terrain_scale, SKY_WAVES};
#endif
  real sum[SKY_WAVES / LANES];
  for (int g = 0; g < SKY_WAVES / LANES; ++g) sum[g] = SPREAD(0);
  float mean = 0.0f, square = 0.0f;
  for (int first = 0; first < view.samples; first += LANES) {
    real x = SPREAD(0), y = SPREAD(0); /* a sample a lane: where it looks; then each in turn, a wavelength a lane */
    for (int i = 0; i < LANES; ++i) {
      float sample_x, sample_y;
      sample_place(&view, column, row, view.first_sample + first + i, &sample_x, &sample_y);
      LANE(x, i) = sample_x;
      LANE(y, i) = sample_y;
    }
    const SkyDirection d = view_direction(&view, x, y);
    const real half_azimuth = sine_half_from_sun(&view, d.azimuth_rad);
    for (int i = 0; i < min(LANES, view.samples - first); ++i) {
      const float at = clamp((LANE(d.elevation_rad, i) - view.first_elevation_rad) * view.entries_per_rad, 0.0f,
                             (float)(view.entries - 1));
      const int entry = min((int)at, view.entries - 2);
      const SkySample from =
          sky_sample(&view, table, waves, entry, at - (float)entry, LANE(d.azimuth_rad, i), LANE(half_azimuth, i));
#if defined(WITH_TARGETS)
      const SkySample from_sea =
          sky_sample(&view, table, waves, scale.sea_entry, 0.0f, LANE(d.azimuth_rad, i), LANE(half_azimuth, i));
#endif
      real band = SPREAD(0);
#if defined(WITH_TERRAIN)
      const TerrainSight sight_of_terrain = terrain_sight(&terrain, at, LANE(d.azimuth_rad, i));
      TerrainHit met = first_terrain(&terrain, &sight_of_terrain, 0);
#endif
      for (int g = 0; g < SKY_WAVES / LANES; ++g) {
        real radiance = sky_radiance(&view, table, disks, waves, g * LANES, &from);
#if defined(WITH_TARGETS)
        const float azimuth = LANE(d.azimuth_rad, i);
        real sea = radiance;
        if (waves_hide(&targets, g * LANES, entry, at - (float)entry, azimuth))
          sea = sky_radiance(&view, table, disks, waves, g * LANES, &from_sea);
        real terrain_m = SPREAD(0);
#if defined(WITH_TERRAIN)
        if (g > 0 && terrain_scale.waves > 1) met = first_terrain(&terrain, &sight_of_terrain, g * LANES);
        terrain_m = met.distance_m;
        radiance =
            light_of_terrain(&view, &terrain, &sight_of_terrain, &met, radiance, g * LANES, LANE(half_azimuth, i));
        const mask nearer = (terrain_m > 0.0f) & (terrain_m < terrain_scale.sea_horizon_m);
        sea = nearer ? radiance : sea;
#endif
        radiance = before_targets(&view, &targets, radiance, sea, terrain_m, g * LANES, entry, at - (float)entry,
                                  azimuth, LANE(half_azimuth, i));
#endif
        sum[g] += radiance;
        band += radiance;
      }
      float total = 0.0f;
      for (int k = 0; k < LANES; ++k) total += LANE(band, k);
      mean += total;
      square += total * total;
    }
  }
  const bool more = view.first_sample > 0;
  for (int g = 0; g < SKY_WAVES / LANES; ++g) {
    __global float *out = spectra + pixel * waves + g * LANES;
    store_lanes(out, more ? load_lanes(out) + sum[g] : sum[g]);
  }
  moments[2 * pixel] = more ? moments[2 * pixel] + mean : mean;
  moments[2 * pixel + 1] = more ? moments[2 * pixel + 1] + square : square;
}
