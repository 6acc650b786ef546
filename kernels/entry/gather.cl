/* How much light lands at places: within a radius, or from the nearest k photons. One work-item answers
   POINTS_PER_ITEM neighbouring questions. */
#pragma OPENCL FP_CONTRACT OFF /* who is inside is then the same on every device and in C++ */
#include "lib/language.h"

#include "lib/lane_bits.h"
#include "lib/lanes.h"
#include "lib/vec3.h"

#include "lib/pack.h"
#include "shared/photon.h"
#include "shared/photon_grid.h"

#include "map/grid.h"

#include "map/photon_arrays.h"

#include "map/blocks.h"

#include "map/crowd.h"

#include "map/gather.h"

#include "map/nearest.h"

#define MAP_ARGUMENTS                                                                                                \
  __global const int *cell_start, __global const float *boxes, __global const float *x_m, __global const float *y_m, \
      __global const float *z_m, __global const int *normal, __global const float *power_W, const int stride,        \
      const PhotonGrid grid
#define MAP \
  { cell_start, boxes, x_m, y_m, z_m, normal, power_W, stride }

#define ANSWERS                                                                                        \
  __global const GatherPoint *points, __global float *irradiance_W_m2, __global GatherSpread *spreads, \
      __global Gathered *gathered, const int count, const GatherSettings settings

__kernel void gather_radius(MAP_ARGUMENTS, ANSWERS, __global const float *radius_m) {
  const PhotonArrays map = MAP;
  const int first = (int)get_global_id(0) * POINTS_PER_ITEM, last = min(first + POINTS_PER_ITEM, count);
  for (int i = first; i < last; ++i) {
    const GatherPoint point = points[i];
    const Asking question = asking(&point, &settings);
    const float radius = settings.radius_m > 0 ? settings.radius_m : radius_m[i];
    GatherSpread spread;
    gathered[i].count = gather_within(&map, &grid, &question, scalar_smaller(radius * radius, HUGE_F),
                                      irradiance_W_m2 + i * WAVES, &spread);
    gathered[i].radius_m = radius;
    spreads[i] = spread;
  }
}

__kernel void gather_nearest(MAP_ARGUMENTS, ANSWERS) {
  const PhotonArrays map = MAP;
  const int first = (int)get_global_id(0) * POINTS_PER_ITEM, last = min(first + POINTS_PER_ITEM, count);
  float guess_m = settings.guess_m;
  Distances distances;
  distances.map = &map;
  distances.grid = &grid;
  for (int i = first; i < last; ++i) {
    const GatherPoint point = points[i];
    const Asking question = asking(&point, &settings);
    distances.asking = &question;
    const float radius2 = nearest_radius2(&distances, &settings, &guess_m);
    GatherSpread spread;
    gathered[i].count = gather_within(&map, &grid, &question, radius2, irradiance_W_m2 + i * WAVES, &spread);
    gathered[i].radius_m = scalar_root(radius2);
    spreads[i] = spread;
  }
}
