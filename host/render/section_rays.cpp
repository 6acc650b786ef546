#include "render/section_rays.hpp"

#include <algorithm>
#include <cmath>

#include "compute/section_tracer.hpp"
#include "render/spectrum.hpp"

namespace greenray {

f64_section::RayStart launch(const SectionTable &table, std::size_t row, const SectionEye &eye, double elevation_rad,
                             double azimuth_rad, double distance_m) {
  const double z_m = f64::flattened_height_m(eye.height_m, table.curvature_per_m);
  const double index = std::exp(std::log1p(table.refractivity(row, z_m, eye.x_m)) + z_m * table.curvature_per_m);
  const std::size_t column = table.find_column(row, eye.x_m);
  const SectionColumnData &c = table.column(row, column);
  const std::size_t cell = table.find_cell(c, z_m);
  f64_section::RayStart ray{};
  ray.run = index * std::cos(elevation_rad);
  ray.rise = index * std::sin(elevation_rad);
  ray.sigma_end_m = distance_m >= until_it_leaves ? until_it_leaves : std::min(distance_m, 0.9 * ENDLESS_M);
  ray.row = static_cast<int>(row);
  ray.column = static_cast<int>(column);
  ray.cell = static_cast<int>(cell);
  ray.above_m = z_m - table.cells[c.first_cell + cell].bottom_m;
  ray.along_m = eye.x_m - c.left_m;
  ray.course = std::cos(azimuth_rad);
  ray.beam = azimuth_rad == 0 ? 0 : std::sin(azimuth_rad);
  return ray;
}

HostSection::HostSection(const SectionTable &table)
    : curvature_per_m_(table.curvature_per_m),
      cells_(section_cells<f64_section::SectionCell>(table)),
      columns_(section_columns<f64_section::SectionColumn>(table)),
      rows_(section_rows<f64_section::SectionRow>(table)) {}

f64_section::RayEnd HostSection::trace(const f64_section::RayStart &start, double tolerance_rad) const {
  const f64_section::SectionTable parts{cells_.data(), columns_.data(), rows_.data()};
  const f64_section::TraceSettings settings{tolerance_rad, 10000000, 0};
  const f64_section::Absorbers absorbers{curvature_per_m_, ozone_peak_m, ozone_width_m, 1200};
  f64_section::March march;
  f64_section::start_march(&march, parts, &start, 0, 0, &settings, absorbers);
  f64_section::trace(&march, parts, &settings);
  f64_section::RayEnd end;
  f64_section::record(&march, &end, 0, 0);
  return end;
}

f64::RayEnd plain(const f64_section::RayEnd &end, const SectionTable &table) {
  f64::RayEnd e{};
  e.above_m = end.above_m + table.cells[static_cast<std::size_t>(end.cell)].bottom_m;
  e.run = end.run;
  e.rise = end.rise;
  e.sigma_m = end.sigma_m;
  e.bending_rad = end.bending_rad;
  e.optical_path_m = end.optical_path_m;
  std::copy(std::begin(end.column), std::end(end.column), e.column);
  e.min_z_m = end.min_z_m;
  e.max_z_m = end.max_z_m;
  e.solver_error_rad = end.solver_error_rad;
  e.bouguer_drift = end.bouguer_drift;
  e.outcome = end.outcome;
  e.turning_points = end.turning_points;
  e.steps = end.steps;
  e.rejected = end.rejected;
  return e;
}

}  // namespace greenray
