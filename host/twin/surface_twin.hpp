// The host twin of paths among surfaces: the text of kernels/surface compiled as C++20, once per namespace.
//   surface32           one float at a time, through a medium that bends paths; its structs are the device's
//   surface64           the same in double
//   surface32_straight  without curve code
#pragma once
#include <cmath>

#define LANES 1
#define REAL_IS_DOUBLE 0
#define AIR_IS_CURVED 1
namespace greenray::surface32 {
#include "twin/surface_text.hpp"
}
#undef AIR_IS_CURVED
#define AIR_IS_CURVED 0
namespace greenray::surface32_straight {
#include "twin/surface_text.hpp"
}
#undef AIR_IS_CURVED
#undef REAL_IS_DOUBLE
#define REAL_IS_DOUBLE 1
#define AIR_IS_CURVED 1
namespace greenray::surface64 {
#include "twin/surface_text.hpp"
}
#undef AIR_IS_CURVED
#undef REAL_IS_DOUBLE
#undef LANES

namespace greenray {
static_assert(sizeof(surface32::SurfaceTriangle) == 120 && sizeof(surface32::SurfaceSphere) == 24);
static_assert(sizeof(surface32::GeometryBounds) == 40 && sizeof(surface32::AirCell) == 16);
static_assert(sizeof(surface32::AirLayer) == 32 && sizeof(surface32::AirShape) == 16);
static_assert(sizeof(surface32::PathStart) == 32 && sizeof(surface32::PathEnd) == 64);
}  // namespace greenray
