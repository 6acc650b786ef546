#include "render/host_rays.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "render/launch.hpp"
#include "support/angle.hpp"

namespace greenray {

f64::RayEnd trace_on_host(const IndexTable &table, std::size_t row, double height_m, double elevation_rad,
                          const LayerAbsorbers &shapes, double step_rad) {
  std::vector<f64::IndexCell> cells;
  for (std::size_t i = 0; i < table.cells_per_row; ++i) {
    const IndexCellData &c = table.cell(row, i);
    f64::IndexCell cell{};
    std::copy(std::begin(c.gradient), std::end(c.gradient), cell.gradient);
    std::copy(std::begin(c.density), std::end(c.density), cell.density);
    cell.bottom_m = c.bottom_m, cell.thickness_m = c.thickness_m;
    cell.log_index = c.log_index, cell.step_cap_m = c.step_cap_m;
    cells.push_back(cell);
  }
  f64::RayStart start = launch(table, row, height_m, elevation_rad);
  start.row = 0;
  const f64::TraceSettings settings{step_rad, 100000, static_cast<int>(table.cells_per_row)};
  const f64::Absorbers absorbers{table.curvature_per_m, shapes.ozone_peak_m, shapes.ozone_width_m,
                                 shapes.aerosol_scale_m};
  f64::March march;
  f64::start_march(&march, cells.data(), &start, 0, 0, &settings, absorbers);
  f64::trace(&march, cells.data(), &settings);
  f64::RayEnd end;
  f64::record(&march, &end, 0, 0);
  return end;
}

HostRay host_ray(IndexTable table, std::size_t row, double height_m) {
  return [table = std::move(table), row, height_m](double e) { return trace_on_host(table, row, height_m, e); };
}

HostRay host_ray(SectionTable table, std::size_t row, const SectionEye &eye, double azimuth_rad) {
  const auto known = std::make_shared<SectionTable>(std::move(table));
  const auto section = std::make_shared<HostSection>(*known);
  return [known, section, row, eye, azimuth_rad](double e) {
    return plain(section->trace(launch(*known, row, eye, e, azimuth_rad)), *known);
  };
}

std::optional<double> horizon_rad(const IndexTable &table, double height_m) {
  return horizon_rad([&](double e) { return trace_on_host(table, 0, height_m, e); });
}

std::optional<double> horizon_rad(const HostRay &ray) {
  const auto in_sky = [&](double e) { return ray(e).outcome == f64::RAY_SPACE; };
  double high = to_rad(1.0), low = -pi / 2;
  if (!in_sky(high) || in_sky(low)) return std::nullopt;
  // The topmost ground ray: step down from the sky in thin steps first, so that ducts below do not confuse the
  // bisection.
  for (double e = high; e > -pi / 2; e -= std::max(1e-5, 0.01 * std::abs(e))) {
    if (!in_sky(e)) {
      low = e;
      break;
    }
    high = e;
  }
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (in_sky(middle) ? high : low) = middle;
  }
  return high;
}

std::optional<double> apparent_altitude_rad(const HostRay &ray, double true_altitude_rad,
                                            const std::optional<double> &horizon) {
  constexpr double above_it = 1e-9;  // so that the ray misses the ground
  const auto not_below = [&](double e) { return horizon ? std::max(e, *horizon + above_it) : e; };
  double e = not_below(true_altitude_rad + from_arcsec(1500));
  for (int i = 0; i < 60; ++i) {
    const f64::RayEnd end = ray(std::min(e, pi / 2));
    if (end.outcome != f64::RAY_SPACE) return std::nullopt;
    const double next = true_altitude_rad + end.bending_rad;
    if (std::abs(next - e) < 1e-10) return next;
    if (not_below(next) == e) return std::nullopt;  // the horizon itself is still too high
    e = not_below(next);
  }
  return std::nullopt;
}

}  // namespace greenray
