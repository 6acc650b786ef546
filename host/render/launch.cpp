#include "render/launch.hpp"

namespace greenray {

f64::RayStart launch(const IndexTable &table, std::size_t row, double height_m, double elevation_rad,
                     double distance_m) {
  f64::RayStart ray;
  const double z_m = f64::flattened_height_m(height_m, table.curvature_per_m);
  const double flattened_index = std::exp(table.log_index(row, z_m) + z_m * table.curvature_per_m);
  ray.run = flattened_index * std::cos(elevation_rad);
  ray.rise = flattened_index * std::sin(elevation_rad);
  const double sigma_m = distance_m / std::max(ray.run, 1e-12);
  ray.sigma_end_m = distance_m >= until_it_leaves ? until_it_leaves : std::min(sigma_m, 0.9 * ENDLESS_M);
  ray.row = static_cast<int>(row);
  ray.cell = static_cast<int>(table.find(z_m));
  ray.above_m = z_m - table.cell(row, static_cast<std::size_t>(ray.cell)).bottom_m;
  return ray;
}

}  // namespace greenray
