// The photon side of kernels/ compiled as C++20: packing, random numbers, samplers, grid; one lane of float.
// Structs that cross the bus are greenray::Photon and its like (compute/photon.hpp).
#pragma once
#include <cmath>

#include "compute/photon.hpp"

#define LANES 1
#define REAL_IS_DOUBLE 0
namespace greenray::photon_twin {
#include "lib/language.h"

#include "lib/lanes.h"
#include "lib/random.h"
#include "lib/vec3.h"

#include "lib/pack.h"
#include "lib/sampling.h"

#include "lib/sampling_probe.h"

#include "map/grid.h"
}  // namespace greenray::photon_twin
#include "twin/undo_macros.hpp"
#undef LANES
#undef REAL_IS_DOUBLE
