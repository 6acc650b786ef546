// The host twin of rays through air that varies along the surface (MEDIUM_VARIES): f32_section, f64_section with
// Dormand-Prince, f32_section_richardson, f64_section_richardson with the paper's stepping. See twin/twin.hpp.
#pragma once
#include "twin/twin.hpp"

#define LANES 1
#define TABLE_IS_IMAGE 0
#define WITH_COLUMNS 1
#define MEDIUM_VARIES 1

#define REAL_IS_DOUBLE 0
#define INTEGRATOR_IS_RICHARDSON 0
namespace greenray::f32_section {
#include "twin/section_text.hpp"
}
#undef INTEGRATOR_IS_RICHARDSON
#define INTEGRATOR_IS_RICHARDSON 1
namespace greenray::f32_section_richardson {
#include "twin/section_text.hpp"
}
#undef INTEGRATOR_IS_RICHARDSON
#undef REAL_IS_DOUBLE

#define REAL_IS_DOUBLE 1
#define INTEGRATOR_IS_RICHARDSON 0
namespace greenray::f64_section {
#include "twin/section_text.hpp"
}
#undef INTEGRATOR_IS_RICHARDSON
#define INTEGRATOR_IS_RICHARDSON 1
namespace greenray::f64_section_richardson {
#include "twin/section_text.hpp"
}
#undef INTEGRATOR_IS_RICHARDSON
#undef REAL_IS_DOUBLE

#undef LANES
#undef TABLE_IS_IMAGE
#undef WITH_COLUMNS
#undef MEDIUM_VARIES

namespace greenray {
static_assert(sizeof(f32_section::SectionCell) == 112 && sizeof(f64_section::SectionCell) == 224);
static_assert(sizeof(f32_section::SectionColumn) == 16 && sizeof(f64_section::SectionColumn) == 24);
static_assert(sizeof(f32_section::SectionRow) == 12 && sizeof(f64_section::SectionRow) == 16);
static_assert(sizeof(f32_section::RayStart) == 40 && sizeof(f64_section::RayStart) == 72);
static_assert(sizeof(f32_section::RayEnd) == 84 && sizeof(f64_section::RayEnd) == 144);
}  // namespace greenray
