/* One work-item follows `chunk` aimed photons into slots of its own in the caustic map, one for each. */
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

__kernel void trace_caustics(GEOMETRY_BUFFERS, AIR_BUFFERS, LOOKS_BUFFERS, __global const LightProjection *projected,
                             __global const int *cells, __global const float *weights, __global Photon *records,
                             __global float *power, __global ChunkTally *tallies, const PhotonSettings settings) {
  const int item = (int)get_global_id(0);
  const unsigned int begin = (unsigned int)item * (unsigned int)settings.chunk;
  if (begin >= settings.photons) return;
  const Geometry geometry = GEOMETRY_OF_BUFFERS;
  const Air air = AIR_OF_BUFFERS;
  const Looks looks = LOOKS_OF_BUFFERS;
  const Projections projections = {projected, cells, weights};
  const size_t slot = (size_t)item * (size_t)settings.slots;
  PhotonStore store;
  store.records[0] = store.records[1] = records + slot;
  store.power[0] = store.power[1] = power + slot * WAVES;
  store.slots[0] = 0;
  store.slots[1] = settings.slots;
  ChunkTally tally;
  clear_tally(&tally);
  const unsigned int end = min(begin + (unsigned int)settings.chunk, settings.photons);
  for (unsigned int i = begin; i < end; ++i)
    ++tally.outcome[follow_caustic(&geometry, &air, &looks, &projections, &settings, settings.first + i, &store,
                                   &tally)];
  clear_rest(&store, &tally);
  tallies[item] = tally;
}
