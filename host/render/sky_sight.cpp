#include "render/sky_sight.hpp"

#include <chrono>
#include <cmath>

#include "render/sun_place.hpp"
#include "scene/scene_file.hpp"
#include "support/angle.hpp"
#include "support/toml_reader.hpp"

namespace greenray {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

constexpr std::size_t lookup_probes = 64;

/// Everything that the rays of sight depend on: the scene's hash without what only lights the picture.
std::string key_of(const Scene &scene, const RenderPlan &plan, const RenderOptions &options) {
  Scene rays = scene;
  rays.sun = {};
  rays.sky = {};
  rays.sky.model = scene.sky.model;                  // an academic sky is black,
  rays.sky.ground_albedo = scene.sky.ground_albedo;  // others are lit from below
  rays.eye = {};
  rays.output = {};
  rays.moon = {};
  const bool lit = scene.sun.given != SunScene::Given::nothing || scene.moon.given != MoonScene::Given::nothing;
  rays.sun.given = lit ? SunScene::Given::true_altitude : SunScene::Given::nothing;  // no light, no sky
  rays.tracing.spp.reset(), rays.tracing.error_pct.reset(), rays.tracing.minutes.reset();
  std::string key = scene_hash(rays) + (options.straight ? " straight" : "");
  for (const double number : {plan.first_elevation_deg, plan.spacing_arcsec, plan.azimuth_from_path_rad})
    key += " " + exact_decimal(number);
  for (const std::vector<double> *nm : {&plan.wavelengths_nm, &plan.bent_nm})
    for (const double number : *nm) key += " " + exact_decimal(number);
  return key + " " + std::to_string(plan.entries) + " " + method_name(plan.method) +
         (plan.precision == Precision::double_ ? " double" : " float") + (plan.section ? " section" : "");
}

}  // namespace

SkySight::SkySight(const Scene &scene, const RenderPlan &plan, const RenderOptions &options,
                   std::shared_ptr<Device> device, const std::function<void(const std::string &phase)> &progress)
    : plan_(plan),
      device_(std::move(device)),
      air_(spec_for(scene, options)),
      flat_(scene.atmosphere.surface == Surface::flat),
      height_m_(scene.observer.height_m),
      table_arcsec_(scene.tracing.table_arcsec) {
  const auto begin = Clock::now();
  if (plan_.terrain) {
    progress("terrain");
    terrain_ = polar_terrain(scene, plan_);
    report_.ground_arcsec = terrain_->error_arcsec;
  }
  progress("table");
  reference_ = reference_ray(scene, air_);
  horizon_rad_ = greenray::horizon_rad(reference_);
  if (plan_.section) rays_.emplace(air_, plan_.bent_nm, ray_options(scene), device_);
  else rays_.emplace(air_.at(0), plan_.bent_nm, ray_options(scene), device_);
  report_.table_cells = rays_->cells();
  report_.table_bound_arcsec = rays_->table_bound_arcsec();
  measure_table();
  const bool lit = scene.sun.given != SunScene::Given::nothing || scene.moon.given != MoonScene::Given::nothing;
  if (scene.sky.model != SkyScene::Model::academic && lit)
    field_ = sky_field(scene, air_.at(0), spectral_air(scene, plan_.wavelengths_nm), plan_.wavelengths_nm);
  report_.build_seconds = seconds_since(begin);
  progress("rays");
  trace_table();
  if (!plan_.station_m.empty() || plan_.rough_sea) trace_targets(scene);
  if (plan_.rough_sea) trace_waves(scene);
  if (plan_.terrain) trace_above_terrain(scene);
}

/// Error of the table: its rays against those of a table thirty times finer, in double on the host. Error of the
/// layers: the device's rays against those in double by steps through the same table.
void SkySight::measure_table() {
  const std::size_t row = plan_.bent_nm.size() / 2;
  const HostRay through_table = rays_->on_host(row);
  const HostRay through_fine = finer_ray(plan_.bent_nm[row]);
  std::vector<double> elevations;
  for (int i = 0; i < 48; ++i)
    elevations.push_back(to_rad(plan_.first_elevation_deg) +
                         from_arcsec(plan_.spacing_arcsec) * static_cast<double>(plan_.entries - 1) * (i + 0.5) / 48);
  const std::vector<f64::RayEnd> ours = rays_->trace(elevations);
  const auto worse = [](double &worst, const f64::RayEnd &a, const f64::RayEnd &b, double stretch) {
    if (a.outcome == f64::RAY_SPACE && b.outcome == f64::RAY_SPACE)
      worst = std::max(worst, to_arcsec(std::abs(a.bending_rad - b.bending_rad)) / stretch);
  };
  for (std::size_t i = 0; i < elevations.size(); ++i) {
    const f64::RayEnd a = through_table(elevations[i]);
    double stretch = 1;  // a duct that varies folds the sky many times over: there, the direction that is seen wrongly
    if (plan_.section) {
      constexpr double beside_rad = 1e-7;
      const f64::RayEnd beside = through_table(elevations[i] + beside_rad);
      if (beside.outcome == a.outcome)
        stretch = std::max(1.0, std::abs(beside.bending_rad - a.bending_rad) / beside_rad);
    }
    worse(report_.table_arcsec, a, through_fine(elevations[i]), stretch);
    if (measures_solver()) worse(report_.solver_arcsec, a, ours[i * plan_.bent_nm.size() + row], stretch);
  }
}

/// Steps through layers tell their own error, an upper bound; that of the others is measured.
bool SkySight::measures_solver() const { return plan_.method == RayMethod::cells || plan_.section; }

/// Rays through a much finer table.
HostRay SkySight::finer_ray(double wavelength_nm) const {
  const double error_arcsec = rays_->index_error_arcsec() / 30;
  if (!plan_.section)
    return host_ray(build_index_table(air_.at(0), {wavelength_nm}, {flat_, error_arcsec, height_m_}), 0, height_m_);
  return host_ray(build_section_table(section_medium(air_, flat_), {wavelength_nm}, {error_arcsec, height_m_}), 0,
                  {0, height_m_}, plan_.azimuth_from_path_rad);
}

SkyRayOptions SkySight::ray_options(const Scene &scene) const {
  SkyRayOptions rays;
  rays.height_m = height_m_;
  rays.flat = flat_;
  rays.method = plan_.method;
  rays.azimuth_rad = plan_.azimuth_from_path_rad;
  rays.precision = plan_.precision;
  rays.error_arcsec = scene.tracing.table_arcsec;
  rays.step_rad = scene.tracing.tolerance;
  rays.max_steps = scene.tracing.max_steps;
  rays.absorbers = {ozone_peak_m, ozone_width_m, scene.atmosphere.aerosol_scale_height_m};
  return rays;
}

void SkySight::trace_table() {
  const auto begin = Clock::now();
  const double compiled_before = device_->compile_seconds();
  const double low = to_rad(plan_.first_elevation_deg), spacing = from_arcsec(plan_.spacing_arcsec);
  const double high = low + spacing * static_cast<double>(plan_.entries - 1);
  // Through a duct that varies the curve may fold without end: it is followed as finely as pixels can show.
  const double finest_rad = plan_.section ? spacing / 16 : 2e-9;
  const double tolerance_arcsec = plan_.section ? std::max(table_arcsec_, plan_.pixel_arcsec / 50) : table_arcsec_;
  curve_ = trace_transfer_curve(*rays_, low, std::min(high, pi / 2), tolerance_arcsec, finest_rad);
  report_.curve_entries = curve_.elevation_rad.size();
  transfer_ = evenly_spaced(curve_, low, spacing, plan_.entries);
  report_.trace = rays_->stats();  // of the picture's own rays; those below are measurements
  probes_ = probe_between(*rays_, transfer_, lookup_probes);
  report_.lookup_arcsec = lookup_error_arcsec(transfer_, probes_);
  const std::size_t bent = plan_.bent_nm.size(), wanted = plan_.wavelengths_nm.size();
  transfer_.rays = for_all_wavelengths(transfer_.rays, bent, wanted);
  transfer_.edges = for_all_wavelengths(transfer_.edges, bent, wanted);
  probes_.rays = for_all_wavelengths(probes_.rays, bent, wanted);
  transfer_.wavelengths = wanted;
  report_.table_in_image = rays_->table_in_image();
  if (!measures_solver()) report_.solver_arcsec = to_arcsec(report_.trace.solver_error_rad);
  report_.emit_seconds = std::max(0.0, seconds_since(begin) - (device_->compile_seconds() - compiled_before));
}

/// Heights at every entry itself, not by the curve's: where a ray is at a distance may fold where its bending does not.
void SkySight::trace_targets(const Scene &scene) {
  const auto begin = Clock::now();
  const double compiled_before = device_->compile_seconds();
  places_.emplace(air_, plan_.bent_nm, ray_options(scene), plan_.section, device_);
  std::vector<double> elevations, middles;  // of a smooth sea the stations; of a rough one without targets none
  for (std::size_t e = 0; e < transfer_.entries; ++e) elevations.push_back(transfer_.elevation_rad(e));
  for (const std::size_t e : probes_.below) middles.push_back(transfer_.elevation_rad(e) + 0.5 * transfer_.spacing_rad);
  stations_ = trace_stations(*places_, elevations, plan_.station_m);
  if (!plan_.station_m.empty())
    report_.target_arcsec = station_error_arcsec(stations_, transfer_.edges, probes_.below,
                                                 trace_stations(*places_, middles, plan_.station_m));
  report_.emit_seconds += std::max(0.0, seconds_since(begin) - (device_->compile_seconds() - compiled_before));
}

void SkySight::trace_waves(const Scene &scene) {
  const auto begin = Clock::now();
  const double compiled_before = device_->compile_seconds();
  std::vector<double> three = plan_.bent_nm;
  if (three.size() > 3) three = {three.front(), three[three.size() / 2], three.back()};
  if (three.size() == 2) three.insert(three.begin() + 1, three.front());
  SightPlaces rays(air_, three, ray_options(scene), plan_.section, device_);
  sea_ = trace_sea(rays, transfer_, plan_.station_m, sea_state(scene.sea), height_m_,
                   scene.atmosphere.profile.earth_radius_m, plan_.section);
  report_.emit_seconds += std::max(0.0, seconds_since(begin) - (device_->compile_seconds() - compiled_before));
}

void SkySight::trace_above_terrain(const Scene &scene) {
  const auto begin = Clock::now();
  const double compiled_before = device_->compile_seconds();
  const auto padded = static_cast<std::size_t>(padded_waves(*device_, static_cast<int>(plan_.wavelengths_nm.size())));
  terrain_sights_ = trace_terrain({air_, ray_options(scene), plan_.section, device_}, plan_.bent_nm, padded, *terrain_,
                                  curve_, transfer_, from_arcsec(plan_.pixel_arcsec));
  report_.terrain_arcsec = terrain_sights_.error_arcsec;
  report_.emit_seconds += std::max(0.0, seconds_since(begin) - (device_->compile_seconds() - compiled_before));
}

std::vector<Transfer> SkySight::rays_at(double altitude_deg) {
  const TransferTable traced = trace_elevations(*rays_, {to_rad(altitude_deg)});
  return for_all_wavelengths(traced.rays, traced.wavelengths, plan_.wavelengths_nm.size());
}

std::shared_ptr<SkySight> sky_sight(const Scene &scene, const RenderPlan &plan, const RenderOptions &options,
                                    const std::shared_ptr<Device> &device, SkySightCache *cache, bool &reused,
                                    const std::function<void(const std::string &phase)> &progress) {
  const std::string key = key_of(scene, plan, options);
  reused = cache && cache->sight && cache->key == key;
  if (reused) return cache->sight;
  if (cache) cache->sight.reset();  // its memory first
  auto sight = std::make_shared<SkySight>(scene, plan, options, device, progress);
  if (cache) *cache = {key, sight};
  return sight;
}

}  // namespace greenray
