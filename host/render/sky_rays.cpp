#include "render/sky_rays.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "compute/layer_tracer.hpp"
#include "render/host_rays.hpp"
#include "render/launch.hpp"
#include "render/renderer.hpp"
#include "render/section_rays.hpp"
#include "support/angle.hpp"

namespace greenray {

const char *method_name(RayMethod method) {
  return method == RayMethod::cells ? "cells" : method == RayMethod::richardson ? "richardson" : "rk";
}

struct SkyRays::State {
  State(const Profile &profile, const std::vector<double> &wavelengths_nm, const SkyRayOptions &o,
        std::shared_ptr<Device> d)
      : options(o),
        device(std::move(d)),
        table(build_index_table(profile, wavelengths_nm, {o.flat, index_error_arcsec(), o.height_m})) {
    if (options.method == RayMethod::cells) {
      LayerTable merged = layers();
      merge_far_layers(merged, table, options.absorbers, options.error_arcsec, false);
      layer_tracer.emplace(device, merged, options.precision, stop_if_asked);
      return;
    }
    step_tracer.emplace(device, table, stepping());
  }

  State(const AirSection &air, const std::vector<double> &wavelengths_nm, const SkyRayOptions &o,
        std::shared_ptr<Device> d)
      : options(o), device(std::move(d)) {
    section = build_section_table(section_medium(air, options.flat), wavelengths_nm,
                                  {options.error_arcsec, options.height_m});
    section_tracer.emplace(device, *section, stepping());
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

  double index_error_arcsec() const {
    return options.method == RayMethod::cells && !section ? std::max(options.error_arcsec / 30, 1e-9)
                                                          : options.error_arcsec;
  }

  const LayerTable &layers() {
    if (layer_table.wavelength_nm.empty()) {
      const double eye_m = f64::flattened_height_m(options.height_m, table.curvature_per_m);
      const double error_arcsec = std::max(options.error_arcsec, 2e-8);
      layer_table = build_layer_table(table, place_layers(table, 0, eye_m, error_arcsec), eye_m, options.absorbers);
    }
    return layer_table;
  }

  SkyRayOptions options;
  std::shared_ptr<Device> device;
  std::optional<SectionTable> section;  // before the table, whose error it decides
  IndexTable table;
  LayerTable layer_table;
  std::optional<LayerTracer> layer_tracer;
  std::optional<RayTracer> step_tracer;
  std::optional<SectionTracer> section_tracer;
};

SkyRays::SkyRays(const Profile &profile, const std::vector<double> &wavelengths_nm, const SkyRayOptions &options,
                 std::shared_ptr<Device> device)
    : state_(std::make_unique<State>(profile, wavelengths_nm, options, std::move(device))) {}
SkyRays::SkyRays(const AirSection &air, const std::vector<double> &wavelengths_nm, const SkyRayOptions &options,
                 std::shared_ptr<Device> device)
    : state_(std::make_unique<State>(air, wavelengths_nm, options, std::move(device))) {}
SkyRays::~SkyRays() = default;

std::vector<f64::RayEnd> SkyRays::trace(std::span<const double> elevations_rad, std::span<const double> azimuths_rad,
                                        std::vector<double> *sideways_rad) {
  if (!varies()) return trace(elevations_rad);
  const SectionTable &section = *state_->section;
  std::vector<f64_section::RayStart> starts;
  starts.reserve(elevations_rad.size() * section.wavelength_nm.size());
  for (std::size_t i = 0; i < elevations_rad.size(); ++i)
    for (std::size_t row = 0; row < section.wavelength_nm.size(); ++row)
      starts.push_back(
          launch(section, row, {options().place_m, options().height_m}, elevations_rad[i], azimuths_rad[i]));
  std::vector<f64::RayEnd> ends;
  ends.reserve(starts.size());
  for (const f64_section::RayEnd &end : state_->section_tracer->trace(starts)) {
    ends.push_back(plain(end, section));
    if (sideways_rad) sideways_rad->push_back(end.sideways_rad);
  }
  return ends;
}

std::vector<f64::RayEnd> SkyRays::trace(std::span<const double> elevations_rad) {
  if (varies()) return trace(elevations_rad, std::vector<double>(elevations_rad.size(), options().azimuth_rad));
  if (state_->layer_tracer) return state_->layer_tracer->trace(elevations_rad);
  std::vector<f64::RayStart> starts;
  starts.reserve(elevations_rad.size() * table().wavelength_nm.size());
  for (double elevation : elevations_rad)
    for (std::size_t row = 0; row < table().wavelength_nm.size(); ++row)
      starts.push_back(launch(table(), row, options().height_m, elevation));
  return state_->step_tracer->trace(starts);
}

const LayerTable &SkyRays::layers() { return state_->layers(); }
HostRay SkyRays::on_host(std::size_t row) const {
  if (varies()) return host_ray(*state_->section, row, {options().place_m, options().height_m}, options().azimuth_rad);
  return [this, row](double e) { return trace_on_host(table(), row, options().height_m, e); };
}

const IndexTable &SkyRays::table() const { return state_->table; }
const SectionTable &SkyRays::section() const { return *state_->section; }
bool SkyRays::varies() const { return state_->section.has_value(); }
const std::vector<double> &SkyRays::wavelengths_nm() const {
  return varies() ? state_->section->wavelength_nm : state_->table.wavelength_nm;
}
double SkyRays::curvature_per_m() const {
  return varies() ? state_->section->curvature_per_m : state_->table.curvature_per_m;
}
double SkyRays::table_bound_arcsec() const {
  return varies() ? state_->section->bound_arcsec : state_->table.bound_arcsec;
}
std::size_t SkyRays::cells() const {
  if (varies()) return state_->section->cells.size();
  if (!state_->layer_tracer) return state_->table.cells_per_row;
  return state_->layer_table.above.front().layers.size() + state_->layer_table.below.front().layers.size();
}
const TraceStats &SkyRays::stats() const {
  if (varies()) return state_->section_tracer->stats();
  return state_->layer_tracer ? state_->layer_tracer->stats() : state_->step_tracer->stats();
}
bool SkyRays::table_in_image() const { return state_->step_tracer && state_->step_tracer->uses_image(); }
double SkyRays::index_error_arcsec() const { return state_->index_error_arcsec(); }
const SkyRayOptions &SkyRays::options() const { return state_->options; }

namespace {

double turning_elevation_rad(double lift) { return std::atan(std::sqrt(std::max(-lift, 0.0))); }

/// Elevations that just clear the successive lowest lifts of a side, ascending.
std::vector<double> clearances_rad(const std::vector<LayerData> &layers) {
  std::vector<double> found;
  double lowest = 0;
  for (std::size_t k = 0; k < layers.size(); ++k) {
    if (layers[k].lift >= lowest) continue;
    lowest = layers[k].lift;
    if (k + 1 == layers.size() || layers[k + 1].lift > lowest) found.push_back(turning_elevation_rad(lowest));
  }
  return found;
}

}  // namespace

std::vector<double> breaks_rad(const LayerTable &layers, std::size_t wavelength) {
  const std::vector<LayerData> &up = layers.above[wavelength].layers, &down = layers.below[wavelength].layers;
  const std::vector<double> above = clearances_rad(up), below = clearances_rad(down);
  std::vector<double> breaks;
  for (double e : above) {
    breaks.push_back(e);
    if (!below.empty() && e < below.back()) breaks.push_back(-e);  // on the way back from a turn below the eye
  }
  for (double e : below) {
    breaks.push_back(-e);
    if (!above.empty() && e < above.back()) breaks.push_back(e);
  }
  const bool at_a_crest = !up.empty() && !down.empty() && up.front().lift < 0 && down.front().lift < 0;
  if (at_a_crest || down.empty()) breaks.push_back(0);  // level rays part here; on the ground they begin
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  return breaks;
}

std::vector<double> turning_knots_rad(const LayerTable &layers, std::size_t wavelength) {
  std::vector<double> knots;
  for (const LayerSide *side : {&layers.above[wavelength], &layers.below[wavelength]})
    for (const LayerData &layer : side->layers)
      if (layer.lift < 0)
        for (double sign : {-1.0, 1.0}) knots.push_back(sign * turning_elevation_rad(layer.lift));
  std::sort(knots.begin(), knots.end());
  return knots;
}

}  // namespace greenray
