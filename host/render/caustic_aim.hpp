// Projection maps: which photons of which light meet glass, mirrors and rough surfaces, found by tracing some.
#pragma once
#include "compute/room_tracer.hpp"

namespace greenray {

struct CausticAim {
  AimedLights lights;
  std::vector<double> share;  // of each light's domain that is marked, at least what exploring it is worth
  std::size_t marked = 0;     // cells of all lights
};

/* Tries every cell of every light's emission with some photons through the bent medium and marks those that meet a
   surface which is not Lambert, and their neighbours. A tenth of the photons explores all cells evenly. */
CausticAim find_caustic_aim(RoomTracer &tracer, const RoomLooks &looks, const PhotonBatch &like);

}  // namespace greenray
