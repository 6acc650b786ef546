/* One work-item follows `chunk` photons, one after the other, into slots of its own in both maps. */
#include "surface/surface.h"

#include "lib/random.h"

#include "lib/pack.h"
#include "lib/sampling.h"
#include "shared/light.h"
#include "shared/material.h"
#include "shared/photon.h"

#include "surface/looks.h"

#include "surface/scatter.h"

#include "surface/emit.h"

#include "surface/photon_path.h"

__kernel void trace_photons(GEOMETRY_BUFFERS, AIR_BUFFERS, LOOKS_BUFFERS, __global Photon *diffuse,
                            __global float *diffuse_power, __global Photon *caustic, __global float *caustic_power,
                            __global ChunkTally *tallies, const PhotonSettings settings, const int caustic_slots) {
  const int item = (int)get_global_id(0);
  const unsigned int begin = (unsigned int)item * (unsigned int)settings.chunk;
  if (begin >= settings.photons) return;
  const Geometry geometry = GEOMETRY_OF_BUFFERS;
  const Air air = AIR_OF_BUFFERS;
  const Looks looks = LOOKS_OF_BUFFERS;
  const size_t slot = (size_t)item * (size_t)settings.slots, rare = (size_t)item * (size_t)caustic_slots;
  PhotonStore store;
  store.records[0] = diffuse + slot;
  store.power[0] = diffuse_power + slot * WAVES;
  store.records[1] = caustic + rare;
  store.power[1] = caustic_power + rare * WAVES;
  store.slots[0] = settings.slots;
  store.slots[1] = caustic_slots;
  ChunkTally tally;
  clear_tally(&tally);
  const unsigned int end = min(begin + (unsigned int)settings.chunk, settings.photons);
  for (unsigned int i = begin; i < end; ++i)
    ++tally.outcome[follow_photon(&geometry, &air, &looks, &settings, settings.first + i, &store, &tally)];
  clear_rest(&store, &tally);
  tallies[item] = tally;
}
