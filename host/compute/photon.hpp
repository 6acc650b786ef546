// The photon record and the grid as host and device see them, for every namespace of greenray.
#pragma once

namespace greenray {
#include "shared/photon.h"
#include "shared/photon_grid.h"
static_assert(sizeof(Photon) == 32 && sizeof(GatherPoint) == 16);
static_assert(sizeof(PhotonGrid) == 32 && sizeof(GatherSettings) == 20 && sizeof(Gathered) == 8 &&
              sizeof(GatherSpread) == 8);
}  // namespace greenray
