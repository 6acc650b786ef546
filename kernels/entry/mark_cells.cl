/* One work-item tries one cell of one light: how many of its photons meet glass, mirrors or rough surfaces first. */
#include "surface/surface.h"

#include "lib/random.h"

#include "lib/pack.h"
#include "lib/sampling.h"
#include "shared/light.h"
#include "shared/material.h"
#include "shared/photon.h"
#include "shared/projection.h"

#include "surface/looks.h"

#include "surface/scatter.h"

#include "surface/emit.h"

#include "surface/photon_path.h"

#include "surface/projection.h"

__kernel void mark_cells(GEOMETRY_BUFFERS, AIR_BUFFERS, LOOKS_BUFFERS, __global const LightProjection *projections,
                         __global int *counts, const PhotonSettings settings, const int samples) {
  const int item = (int)get_global_id(0), light = item >> PROJECTION_BITS;
  if (light >= settings.lights) return;
  const Geometry geometry = GEOMETRY_OF_BUFFERS;
  const Air air = AIR_OF_BUFFERS;
  const Looks looks = LOOKS_OF_BUFFERS;
  const LightProjection projection = projections[light];
  counts[item] =
      count_specular(&geometry, &air, &looks, &settings, &projection, light, item & (PROJECTION_CELLS - 1), samples);
}
