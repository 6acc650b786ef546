#include "render/transfer.hpp"

#include <algorithm>
#include <cmath>

#include "render/host_rays.hpp"
#include "render/launch.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

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

std::vector<Transfer> trace_rays(RayTracer &tracer, const IndexTable &index, double height_m,
                                 const std::vector<double> &elevations_rad) {
  std::vector<f64::RayStart> starts;
  starts.reserve(elevations_rad.size() * index.wavelength_nm.size());
  for (double elevation : elevations_rad)
    for (std::size_t w = 0; w < index.wavelength_nm.size(); ++w)
      starts.push_back(launch(index, w, height_m, elevation));
  const std::vector<f64::RayEnd> ends = tracer.trace(starts);
  std::vector<Transfer> rays;
  rays.reserve(ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i)
    rays.push_back(transfer_of(ends[i], elevations_rad[i / index.wavelength_nm.size()], index.curvature_per_m));
  return rays;
}

}  // namespace

bool joined(const Transfer &a, const Transfer &b) { return a.outcome == b.outcome; }

TransferTable trace_transfer(RayTracer &tracer, const IndexTable &index, double height_m, double first_elevation_rad,
                             double spacing_rad, std::size_t entries) {
  TransferTable table;
  table.first_elevation_rad = first_elevation_rad;
  table.spacing_rad = spacing_rad;
  table.entries = entries;
  table.wavelengths = index.wavelength_nm.size();
  std::vector<double> elevations(entries);
  for (std::size_t i = 0; i < entries; ++i) elevations[i] = std::clamp(table.elevation_rad(i), -pi / 2, pi / 2);
  table.rays = trace_rays(tracer, index, height_m, elevations);
  return table;
}

void find_edges(TransferTable &table, const IndexTable &index, double height_m) {
  table.edges.assign(table.rays.size(), 1.0f);
  for (std::size_t e = 0; e + 1 < table.entries; ++e)
    for (std::size_t w = 0; w < table.wavelengths; ++w) {
      if (joined(table.at(e, w), table.at(e + 1, w))) continue;
      double low = 0, high = 1;
      for (int i = 0; i < 12; ++i) {
        const double middle = 0.5 * (low + high);
        const double elevation = table.elevation_rad(e) + middle * table.spacing_rad;
        const bool below = trace_on_host(index, w, height_m, elevation).outcome == table.at(e, w).outcome;
        (below ? low : high) = middle;
      }
      table.edges[e * table.wavelengths + w] = static_cast<float>(std::min(0.5 * (low + high), 0.999));
    }
}

TransferTable trace_elevations(RayTracer &tracer, const IndexTable &index, double height_m,
                               const std::vector<double> &elevations_rad) {
  TransferTable table;
  table.entries = elevations_rad.size();
  table.wavelengths = index.wavelength_nm.size();
  table.rays = trace_rays(tracer, index, height_m, elevations_rad);
  return table;
}

TransferProbes probe_between(RayTracer &tracer, const IndexTable &index, double height_m, const TransferTable &table,
                             std::size_t probes) {
  const std::size_t stride = std::max<std::size_t>(1, (table.entries - 1) / std::max<std::size_t>(probes, 1));
  TransferProbes result;
  std::vector<double> elevations;
  for (std::size_t i = 0; i + 1 < table.entries; i += stride) {
    result.below.push_back(i);
    elevations.push_back(std::clamp(table.elevation_rad(i) + 0.5 * table.spacing_rad, -pi / 2, pi / 2));
  }
  result.rays = trace_rays(tracer, index, height_m, elevations);
  return result;
}

double lookup_error_arcsec(const TransferTable &table, const TransferProbes &probes) {
  double worst = 0;
  for (std::size_t k = 0; k < probes.below.size(); ++k)
    for (std::size_t w = 0; w < table.wavelengths; ++w) {
      const Transfer &a = table.at(probes.below[k], w), &b = table.at(probes.below[k] + 1, w);
      const Transfer &middle = probes.rays[k * table.wavelengths + w];
      if (a.outcome != f64::RAY_SPACE || !joined(a, b) || !joined(a, middle)) continue;
      const double stretch = std::abs(b.true_altitude_rad - a.true_altitude_rad) / table.spacing_rad;
      const double miss = std::abs(0.5 * (a.true_altitude_rad + b.true_altitude_rad) - middle.true_altitude_rad);
      worst = std::max(worst, miss / std::max(1.0, stretch));
    }
  return to_arcsec(worst);
}

}  // namespace greenray
