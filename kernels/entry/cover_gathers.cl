/* One work-item finds the support of one gather. */
#include "surface/surface.h"

#include "lib/random.h"

#include "lib/pack.h"
#include "lib/sampling.h"
#include "shared/cover.h"
#include "shared/light.h"
#include "shared/material.h"
#include "shared/photon.h"

#include "surface/looks.h"

#include "surface/cover.h"

__kernel void cover_gathers(GEOMETRY_BUFFERS, AIR_BUFFERS, LOOKS_BUFFERS, __global const GatherPoint *points,
                            __global const float *radius_m, __global Cover *covers, const CoverSettings settings) {
  const int i = (int)get_global_id(0);
  if (i >= settings.count) return;
  const Geometry geometry = GEOMETRY_OF_BUFFERS;
  const GatherPoint point = points[i];
  const CoverDisc disc = cover_disc(&geometry, &point, radius_m[i], &settings);
  /* Turned by where the place is, not by its number: the same in any batch. */
  const RandomWords where = {{as_uint(point.place_m[0]), as_uint(point.place_m[1]), as_uint(point.place_m[2]), 0u}};
  covers[i] = find_cover(&geometry, materials, &disc, R(unit_interval(philox(where, 0x436f76u, 0u).word[0])));
}
