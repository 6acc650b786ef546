// The photon record as host and device see it, for every namespace of greenray.
#pragma once

namespace greenray {
#include "shared/photon.h"
static_assert(sizeof(Photon) == 32 && sizeof(GatherPoint) == 16);
}  // namespace greenray
