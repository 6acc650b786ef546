#include "render/near_rays.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "compute/layer_tracer.hpp"
#include "render/refraction.hpp"
#include "render/renderer.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

constexpr double layer_error_arcsec = 1e-4, fine_error_arcsec = 1e-5;  // of direction: 0.01 mm over 20 km

/// The medium in layers for places inside it, none merged.
LayerTable layers_of(const Profile &profile, double height_m, double wavelength_nm, bool flat) {
  const IndexTable fine = build_index_table(profile, {wavelength_nm}, {flat, fine_error_arcsec, height_m});
  const double eye_m = f64::flattened_height_m(height_m, fine.curvature_per_m);
  return build_layer_table(fine, place_layers(fine, 0, eye_m, layer_error_arcsec), eye_m, {});
}

/// Where a ray ended after the distance before: along the mean of its two directions. Steps tell the place only.
double ended_at_m(const NearRay &before, const NearRay &end) {
  if (before.outcome == f64::RAY_GROUND || before.outcome == f64::RAY_SPACE) return before.distance_m;
  const double slope = std::tan(0.5 * (before.altitude_rad + end.altitude_rad));
  const double run_m = slope == 0 ? 0 : (end.height_m - before.height_m) / slope;
  return std::clamp(before.distance_m + run_m, before.distance_m, end.distance_m);
}

}  // namespace

struct NearRays::State {
  const AirSection &air;
  TraceRequest request;
  std::shared_ptr<Device> device;
  double earth_radius_m;
  std::optional<LayerTracer> layers;
};

NearRays::NearRays(const AirSection &air, double height_m, double wavelength_nm, bool flat, bool section,
                   double azimuth_rad, std::shared_ptr<Device> device)
    : state_(new State{air, {}, device, air.spec().earth_radius_m, {}}) {
  TraceRequest &r = state_->request;
  r.height_m = height_m, r.wavelengths_nm = {wavelength_nm}, r.flat = flat;
  r.section = section, r.azimuth_rad = azimuth_rad, r.tolerance_arcsec = 1e-3;
  r.method = section ? RayMethod::dormand_prince : RayMethod::cells;
  r.precision = device->info().has_double ? Precision::double_ : Precision::single_;
  if (!section)
    state_->layers.emplace(std::move(device), layers_of(air.at(0), height_m, wavelength_nm, flat), r.precision,
                           stop_if_asked);
}

NearRays::~NearRays() = default;
double NearRays::height_m() const { return state_->request.height_m; }
double NearRays::earth_radius_m() const { return state_->earth_radius_m; }
bool NearRays::flat() const { return state_->request.flat; }

std::vector<NearRay> NearRays::trace(std::span<const double> elevations_rad, std::span<const double> distances_m) {
  const double curvature = flat() ? 0 : 1 / state_->earth_radius_m;
  std::vector<NearRay> rays;
  rays.reserve(elevations_rad.size() * distances_m.size());
  if (state_->layers) {
    const std::vector<f64::RayEnd> ends = state_->layers->places(elevations_rad, distances_m);
    for (const f64::RayEnd &end : ends)
      rays.push_back(
          {end.outcome,
           end.outcome == f64::RAY_IN_FLIGHT ? distances_m[rays.size() % distances_m.size()] : end.run * end.sigma_m,
           f64::geometric_height_m(end.above_m, curvature), std::atan2(end.rise, end.run), end.bending_rad});
    return rays;
  }
  TraceRequest request = state_->request;
  request.distances_m.assign(distances_m.begin(), distances_m.end());
  for (const double e : elevations_rad) request.altitudes_deg.push_back(to_deg(e));
  for (const TraceRow &row : trace_table(state_->air, request, state_->device)) {
    NearRay ray{row.outcome, row.distance_m, row.height_m, to_rad(row.elevation_deg), from_arcsec(row.bending_arcsec)};
    const bool first = rays.size() % distances_m.size() == 0;
    if (row.outcome != f64::RAY_IN_FLIGHT) {
      const NearRay before = first ? NearRay{0, 0, height_m(), to_rad(row.apparent_altitude_deg), 0} : rays.back();
      ray.distance_m = ended_at_m(before, ray);
    }
    rays.push_back(ray);
  }
  return rays;
}

}  // namespace greenray
