// From an eye and a direction to the start of a ray on the device, prepared in double.
#pragma once
#include "atmosphere/index_table.hpp"
#include "twin/twin.hpp"

namespace greenray {

inline constexpr double until_it_leaves = 1e30;

/// height_m: above the surface; elevation_rad: above the horizontal there, as seen in the air there;
/// distance_m: along the surface, where to stop (until_it_leaves: nowhere). row: wavelength of the table.
f64::RayStart launch(const IndexTable &table, std::size_t row, double height_m, double elevation_rad,
                     double distance_m = until_it_leaves);

}  // namespace greenray
