#include "render/transfer.hpp"

#include <algorithm>
#include <cmath>

#include "support/angle.hpp"

namespace greenray {

Transfer transfer_of(const f64::RayEnd &end, double elevation_rad, double curvature_per_m) {
  Transfer t{};
  t.outcome = end.outcome;
  t.bending_rad = end.bending_rad;
  t.true_altitude_rad = elevation_rad - end.bending_rad;
  t.column = {end.column[0], end.column[1], end.column[2]};
  t.distance_m = end.run * end.sigma_m;
  t.min_height_m = f64::geometric_height_m(end.min_z_m, curvature_per_m);
  return t;
}

TransferTable trace_elevations(SkyRays &rays, const std::vector<double> &elevations_rad) {
  return trace_directions(rays, elevations_rad, std::vector<double>(elevations_rad.size(), 0.0));
}

TransferTable trace_directions(SkyRays &rays, const std::vector<double> &elevations_rad,
                               const std::vector<double> &azimuths_rad) {
  TransferTable table;
  table.entries = elevations_rad.size();
  table.wavelengths = rays.wavelengths_nm().size();
  std::vector<double> from_path;
  for (double azimuth : azimuths_rad) from_path.push_back(rays.options().azimuth_rad + azimuth);
  const std::vector<f64::RayEnd> ends = rays.trace(elevations_rad, from_path);
  table.rays.reserve(ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i)
    table.rays.push_back(transfer_of(ends[i], elevations_rad[i / table.wavelengths], rays.curvature_per_m()));
  return table;
}

TransferProbes probe_between(SkyRays &rays, const TransferTable &table, std::size_t probes) {
  const std::size_t stride = std::max<std::size_t>(1, (table.entries - 1) / std::max<std::size_t>(probes, 1));
  TransferProbes result;
  std::vector<double> elevations;
  for (std::size_t i = 0; i + 1 < table.entries; i += stride) {
    result.below.push_back(i);
    elevations.push_back(std::clamp(table.elevation_rad(i) + 0.5 * table.spacing_rad, -pi / 2, pi / 2));
  }
  result.rays = trace_elevations(rays, elevations).rays;
  return result;
}

double lookup_error_arcsec(const TransferTable &table, const TransferProbes &probes) {
  double worst = 0;
  for (std::size_t k = 0; k < probes.below.size(); ++k)
    for (std::size_t w = 0; w < table.wavelengths; ++w) {
      const Transfer &a = table.at(probes.below[k], w), &b = table.at(probes.below[k] + 1, w);
      const Transfer &middle = probes.rays[k * table.wavelengths + w];
      const bool jumps = !table.edges.empty() && table.edges[probes.below[k] * table.wavelengths + w] < 1;
      if (jumps || a.outcome != f64::RAY_SPACE || b.outcome != a.outcome || middle.outcome != a.outcome) continue;
      const double stretch = std::abs(b.true_altitude_rad - a.true_altitude_rad) / table.spacing_rad;
      const double miss = std::abs(0.5 * (a.true_altitude_rad + b.true_altitude_rad) - middle.true_altitude_rad);
      worst = std::max(worst, miss / std::max(1.0, stretch));
    }
  return to_arcsec(worst);
}

}  // namespace greenray
