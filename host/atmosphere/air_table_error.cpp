#include "atmosphere/air_table_error.hpp"

#include <algorithm>
#include <cmath>

namespace greenray {
namespace {

/// Heights of a test path at sixteen even steps of sigma, arc by arc as on the device.
std::vector<double> heights_on_path(const AirTable &table, const TestPath &start, double length_m) {
  const int layers = static_cast<int>(table.layers.size());
  const surface64::Air air{table.layers.data(), table.rows.data(), {layers, static_cast<int>(table.cells), 0, 0}};
  const int row = static_cast<int>(table.wavelength_nm.size() / 2);
  int layer = surface64::find_air_layer(&air, start.height_m);
  const double n = std::sqrt(surface64::air_index2(&air, row, start.height_m));
  surface64::AirSlab slab = surface64::air_slab(&air, row, layer);
  surface64::Climb climb{start.height_m, n * std::sin(start.elevation_rad), surface64::lift_at(&slab, start.height_m)};
  const double step = length_m / n / 16;
  double sigma = 0;
  std::vector<double> heights;
  for (int i = 0; i < 20000 && heights.size() < 16; ++i) {
    const double z = climb.z, bottom = layer > 0 ? slab.layer.bottom_m : -1e30;
    const surface64::Rise r = surface64::next_rise(&slab, bottom, slab.top_m, 17 * step - sigma, climb);
    climb = r.end;
    while (heights.size() < 16 && step * static_cast<double>(heights.size() + 1) <= sigma + r.sigma) {
      const double along = step * static_cast<double>(heights.size() + 1) - sigma;
      heights.push_back(z + (r.rise + r.bend * along) * along);
    }
    sigma += r.sigma;
    if (r.step == 0) continue;
    layer += r.step;
    slab = surface64::air_slab(&air, row, layer);
    climb.lift = surface64::lift_at(&slab, climb.z);
  }
  heights.resize(16, climb.z);
  return heights;
}

}  // namespace

std::vector<TestPath> test_fan(const std::vector<double> &edges_m) {
  std::vector<TestPath> fan;
  for (std::size_t i = 0; i + 1 < edges_m.size(); ++i)
    for (const double t : {0.05, 0.21, 0.5, 0.83, 0.95})
      for (const double degrees : {0.0, 0.3, 1.0, 3.0, 8.0, 20.0, 45.0, 75.0})
        for (const double sign : {1.0, -1.0})
          fan.push_back({edges_m[i] + t * (edges_m[i + 1] - edges_m[i]), sign * degrees * M_PI / 180});
  return fan;
}

double largest_difference_m(const AirTable &coarse, const AirTable &fine, const std::vector<TestPath> &fan,
                            double length_m) {
  double worst = 0;
  constexpr double nudge_rad = 1e-6;
  for (const TestPath &start : fan) {
    const auto a = heights_on_path(coarse, start, length_m), b = heights_on_path(fine, start, length_m);
    const auto c = heights_on_path(fine, {start.height_m, start.elevation_rad + nudge_rad}, length_m);
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double amplified = std::abs(c[i] - b[i]) / nudge_rad / length_m;
      worst = std::max(worst, std::abs(a[i] - b[i]) / std::max(1.0, amplified));
    }
  }
  return worst;
}

}  // namespace greenray
