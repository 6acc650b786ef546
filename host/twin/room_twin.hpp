// What photons and eye paths hand over between host and device, as the host sees it: structs of kernels/surface and
// kernels/shared in float. Their layouts do not depend on WAVES.
#pragma once
#include <cmath>

#include "compute/photon.hpp"

#define LANES 1
#define REAL_IS_DOUBLE 0
#define AIR_IS_CURVED 1
#define WAVES 8
namespace greenray::room_twin {
#include "surface/surface.h"

#include "lib/random.h"

#include "lib/pack.h"
#include "lib/sampling.h"
#include "shared/cover.h"
#include "shared/light.h"
#include "shared/material.h"
#include "shared/photon.h"
#include "shared/projection.h"

#include "surface/looks.h"

#include "surface/scatter.h"

#include "surface/emit.h"

#include "surface/photon_path.h"

#include "surface/projection.h"

#include "surface/eye_path.h"

#include "surface/cover.h"
}  // namespace greenray::room_twin
#include "twin/undo_macros.hpp"
#undef WAVES
#undef AIR_IS_CURVED
#undef REAL_IS_DOUBLE
#undef LANES
