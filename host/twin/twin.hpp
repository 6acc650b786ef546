// The host twin: the text of kernels/ compiled as C++20, once per namespace.
//   f32, f64             Dormand-Prince;  f32_richardson, f64_richardson  the paper's stepping.
// Structs of f32 and f64 are what the device sees in its buffers: sizes are asserted here and by a probe kernel.
// The kernel headers have no include guards on purpose: each is included exactly once per namespace, by ray/ray.h.
#pragma once
#include <cmath>

#define LANES 1
#define TABLE_IS_IMAGE 0
#define WITH_COLUMNS 1
#define MEDIUM_VARIES 0

#define REAL_IS_DOUBLE 0
#define INTEGRATOR_IS_RICHARDSON 0
namespace greenray::f32 {
#include "twin/kernel_text.hpp"
}
#undef INTEGRATOR_IS_RICHARDSON
#define INTEGRATOR_IS_RICHARDSON 1
namespace greenray::f32_richardson {
#include "twin/kernel_text.hpp"
}
#undef INTEGRATOR_IS_RICHARDSON
#undef REAL_IS_DOUBLE

#define REAL_IS_DOUBLE 1
#define INTEGRATOR_IS_RICHARDSON 0
namespace greenray::f64 {
#include "twin/kernel_text.hpp"
}
#undef INTEGRATOR_IS_RICHARDSON
#define INTEGRATOR_IS_RICHARDSON 1
namespace greenray::f64_richardson {
#include "twin/kernel_text.hpp"
}
#undef INTEGRATOR_IS_RICHARDSON
#undef REAL_IS_DOUBLE
#undef LANES
#undef TABLE_IS_IMAGE
#undef WITH_COLUMNS
#undef MEDIUM_VARIES

namespace greenray {
static_assert(sizeof(f32::IndexCell) == 48 && sizeof(f64::IndexCell) == 96);
static_assert(sizeof(f32::RayStart) == 24 && sizeof(f64::RayStart) == 40);
static_assert(sizeof(f32::RayEnd) == 72 && sizeof(f64::RayEnd) == 128);
static_assert(sizeof(f32::Layer) == 88 && sizeof(f64::Layer) == 176);
static_assert(sizeof(f32::FarNode) == 28 && sizeof(f64::FarNode) == 56);
static_assert(sizeof(f32::LayerRow) == 24 && sizeof(f64::LayerRow) == 48);
static_assert(sizeof(f32::Target) == 48 && sizeof(f32::TargetTexel) == 16);
static_assert(sizeof(f32::Absorbers) == 16 && sizeof(f64::Absorbers) == 32);
}  // namespace greenray
