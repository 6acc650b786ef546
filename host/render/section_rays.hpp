// Rays through air that varies along the surface: from an eye and a direction to starts, and a few on the host twin.
#pragma once
#include <vector>

#include "atmosphere/section_table.hpp"
#include "render/launch.hpp"
#include "twin/section_twin.hpp"

namespace greenray {

/// An eye on the path: its place along it and its height. Directions by elevation and by azimuth from the path.
struct SectionEye {
  double x_m = 0, height_m = 0;
};

/// elevation_rad: above the horizontal at the eye, as seen in the air there; azimuth_rad: clockwise from the direction
/// of x; distance_m: along the surface, where to stop (until_it_leaves: nowhere). row: wavelength of the table.
f64_section::RayStart launch(const SectionTable &table, std::size_t row, const SectionEye &eye, double elevation_rad,
                             double azimuth_rad = 0, double distance_m = until_it_leaves);

/// Rays in double on the host twin.
class HostSection {
 public:
  explicit HostSection(const SectionTable &table);
  /// One ray to its end; tolerance_rad: local error of direction per step.
  f64_section::RayEnd trace(const f64_section::RayStart &start, double tolerance_rad = 1e-12) const;

 private:
  double curvature_per_m_;
  std::vector<f64_section::SectionCell> cells_;
  std::vector<f64_section::SectionColumn> columns_;
  std::vector<f64_section::SectionRow> rows_;
};

/// What ends of both kinds of air have in common; above_m becomes the flattened height above the surface.
f64::RayEnd plain(const f64_section::RayEnd &end, const SectionTable &table);

}  // namespace greenray
