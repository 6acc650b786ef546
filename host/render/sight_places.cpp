#include "render/sight_places.hpp"

#include <cmath>
#include <optional>

#include "compute/layer_tracer.hpp"
#include "render/launch.hpp"
#include "render/renderer.hpp"
#include "render/section_rays.hpp"

namespace greenray {
namespace {

/// Layers are placed by the bending of rays that cross them; a place inside one is some ten times worse.
constexpr double part_of_a_layer = 16;

SightPlace place_of(const f64::RayEnd &end, double distance_m, double curvature_per_m) {
  SightPlace place;
  place.outcome = end.outcome;
  place.height_m = f64::geometric_height_m(end.above_m, curvature_per_m);
  if (end.outcome != f64::RAY_IN_FLIGHT) place.height_m += (distance_m - end.run * end.sigma_m) * end.rise / end.run;
  place.bending_rad = end.bending_rad;
  place.column = {end.column[0], end.column[1], end.column[2]};
  place.turning_points = end.turning_points;
  return place;
}

}  // namespace

struct SightPlaces::State {
  State(const AirSection &air, const std::vector<double> &wavelengths_nm, const SkyRayOptions &o, bool varies,
        std::shared_ptr<Device> device)
      : options(o), curvature_per_m(o.flat ? 0 : 1 / air.at(0).spec().earth_radius_m) {
    if (varies) {
      section = build_section_table(section_medium(air, o.flat), wavelengths_nm, {o.error_arcsec, o.height_m});
      section_tracer.emplace(device, *section, stepping());
      return;
    }
    const bool cells = options.method == RayMethod::cells;
    const double index_arcsec = cells ? std::max(o.error_arcsec / 30, 1e-9) : o.error_arcsec;
    table = build_index_table(air.at(0), wavelengths_nm, {o.flat, index_arcsec, o.height_m});
    if (!cells) {
      step_tracer.emplace(device, table, stepping());
      return;
    }
    const double eye_m = f64::flattened_height_m(o.height_m, table.curvature_per_m);
    const double layer_arcsec = std::max(o.error_arcsec / part_of_a_layer, 2e-8);
    const LayerTable layers =
        build_layer_table(table, place_layers(table, 0, eye_m, layer_arcsec), eye_m, options.absorbers);
    layer_tracer.emplace(device, layers, options.precision, stop_if_asked);
  }

  TraceOptions stepping() const {
    TraceOptions trace;
    trace.precision = options.precision;
    trace.integrator = options.method == RayMethod::richardson ? Integrator::richardson : Integrator::dormand_prince;
    trace.tolerance_rad = options.step_rad;
    trace.max_steps = options.max_steps;
    trace.absorbers = {0, options.absorbers.ozone_peak_m, options.absorbers.ozone_width_m,
                       options.absorbers.aerosol_scale_m};
    trace.between_batches = stop_if_asked;
    return trace;
  }

  std::vector<f64::RayEnd> by_layers(std::span<const double> elevations_rad, std::span<const double> distances_m) {
    return layer_tracer->places(elevations_rad, distances_m);
  }

  /// One ray for each distance.
  std::vector<f64::RayEnd> by_steps(std::span<const double> elevations_rad, std::span<const double> distances_m) {
    std::vector<f64::RayStart> starts;
    for (const double elevation : elevations_rad)
      for (std::size_t row = 0; row < table.wavelength_nm.size(); ++row)
        for (const double distance : distances_m)
          starts.push_back(launch(table, row, options.height_m, elevation, distance));
    std::vector<f64::RayEnd> ends = step_tracer->trace(starts);
    for (f64::RayEnd &end : ends) end.above_m += table.cell(0, static_cast<std::size_t>(end.cell)).bottom_m;
    return ends;
  }

  std::vector<f64::RayEnd> in_section(std::span<const double> elevations_rad, std::span<const double> distances_m,
                                      std::span<const double> azimuths_rad) {
    std::vector<f64_section::RayStart> starts;
    for (std::size_t i = 0; i < elevations_rad.size(); ++i)
      for (std::size_t row = 0; row < section->wavelength_nm.size(); ++row)
        for (const double distance : distances_m)
          starts.push_back(launch(*section, row, {options.place_m, options.height_m}, elevations_rad[i],
                                  options.azimuth_rad + (azimuths_rad.empty() ? 0 : azimuths_rad[i]), distance));
    std::vector<f64::RayEnd> ends;
    for (const f64_section::RayEnd &end : section_tracer->trace(starts)) ends.push_back(plain(end, *section));
    return ends;
  }

  SkyRayOptions options;
  double curvature_per_m;
  IndexTable table;
  std::optional<LayerTracer> layer_tracer;
  std::optional<RayTracer> step_tracer;
  std::optional<SectionTable> section;
  std::optional<SectionTracer> section_tracer;
};

SightPlaces::SightPlaces(const AirSection &air, const std::vector<double> &wavelengths_nm, const SkyRayOptions &options,
                         bool section, std::shared_ptr<Device> device)
    : state_(std::make_unique<State>(air, wavelengths_nm, options, section, std::move(device))) {}
SightPlaces::~SightPlaces() = default;

std::vector<SightPlace> SightPlaces::at(std::span<const double> elevations_rad, std::span<const double> distances_m,
                                        std::span<const double> azimuths_rad) {
  const std::vector<f64::RayEnd> ends = state_->section ? state_->in_section(elevations_rad, distances_m, azimuths_rad)
                                        : state_->layer_tracer ? state_->by_layers(elevations_rad, distances_m)
                                                               : state_->by_steps(elevations_rad, distances_m);
  std::vector<SightPlace> places;
  places.reserve(ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i)
    places.push_back(place_of(ends[i], distances_m[i % distances_m.size()], state_->curvature_per_m));
  return places;
}

}  // namespace greenray
