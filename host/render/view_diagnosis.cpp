#include "render/view_diagnosis.hpp"

#include <algorithm>
#include <cmath>

#include "atmosphere/standard_atmosphere.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

constexpr int air_rows = 240, fan_steps = 160;

SkyRayOptions ray_options(const ViewRequest &request, const Device &device) {
  SkyRayOptions options;
  options.height_m = request.height_m;
  options.flat = request.flat;
  options.method = request.method;
  options.precision = device.info().has_double ? Precision::double_ : Precision::single_;
  options.error_arcsec = request.section ? 0.01 : 0.001;
  options.step_rad = request.section ? 1e-9 : 1e-11;
  options.max_steps = 1000000;
  options.azimuth_rad = request.azimuth_rad;
  return options;
}

/// Through a duct that varies the curve may fold without end: it is followed to what an eye can tell.
MirageOptions mirage_options(bool varies, bool single) {
  if (varies) return {1, 10, 2e-6};
  return single ? MirageOptions{0.05, 0.5, 2e-8} : MirageOptions{};
}

std::vector<AirRow> rows_of(const Profile &profile, double top_m) {
  std::vector<double> heights;
  for (int i = 0; i <= air_rows; ++i) heights.push_back(top_m * i / air_rows);
  for (const double kink : profile.kinks_m())
    for (const double side : {1 - 1e-9, 1 + 1e-9})
      if (kink * side < top_m) heights.push_back(kink * side);
  for (const double feature : profile.features_m())
    if (feature > 0 && feature < top_m) heights.push_back(feature);
  std::sort(heights.begin(), heights.end());
  std::vector<AirRow> rows;
  for (const double h : heights) {
    const double refractivity = profile.refractivity(h, diagnosis_wavelength_nm).value;
    AirRow row{h,
               std::nan(""),
               std::nan(""),
               1e6 * refractivity,
               1e6 * (refractivity + h / profile.spec().earth_radius_m),
               ray_curvature(profile, h)};
    if (profile.is_air()) {
      const AirState air = profile.air(h);
      row.temperature_K = air.temperature_K.value, row.pressure_Pa = air.pressure_Pa.value;
    }
    rows.push_back(row);
  }
  return rows;
}

/// The lowest altitude from which light of the sky comes, if the ground begins there.
std::optional<double> horizon_of(const Mirages &m) {
  for (std::size_t i = m.fates.size(); i-- > 1;)
    if (m.fates[i - 1].outcome == f64::RAY_GROUND) return m.fates[i].low_deg;
  return std::nullopt;
}

/// Altitudes of the fan: from rays that end on the ground before the horizon to ones that leave past all structure.
std::pair<double, double> fan_range_deg(const ViewDiagnosis &d) {
  double low = 0, high = 0;
  const Mirages &m = d.mirages.front();
  for (const FateBand &band : m.fates)
    if (band.low_deg > -89) low = std::min(low, band.low_deg), high = std::max(high, band.low_deg);
  for (const Fold &fold : m.folds)
    high = std::max(high, fold.apparent_altitude_deg), low = std::min(low, fold.apparent_altitude_deg);
  const double span = std::max({0.1, high - low, std::abs(low)});
  return {low - 0.25 * span, high + 0.5 * span};
}

int fate_at(const Mirages &m, double altitude_deg) {
  for (const FateBand &band : m.fates)
    if (altitude_deg < band.high_deg) return band.outcome;
  return m.fates.back().outcome;
}

double farthest_of(const ViewDiagnosis &d, const ViewRequest &request, const AirSection &air) {
  if (request.farthest_m) return *request.farthest_m;
  if (request.target) return 1.25 * request.target->distance_m;
  if (request.section && !air.points_m().empty() && air.points_m().back() > 0) return 1.2 * air.points_m().back();
  double reach = 3 * d.horizon_m.value_or(d.geometric_horizon_m.value_or(5000));
  if (!d.air.ducts.empty()) reach = std::max(reach, 60000.0);
  return std::clamp(reach, 500.0, 4e6);
}

void trace_fan(NearRays &rays, const ViewRequest &request, const AirSection &air, ViewDiagnosis &d) {
  const auto [low, high] = fan_range_deg(d);
  const double farthest = farthest_of(d, request, air);
  std::vector<double> elevations, distances;
  for (int i = 0; i < request.fan_rays; ++i)
    elevations.push_back(to_rad(low + (high - low) * i / (request.fan_rays - 1)));
  const int steps = request.section ? 3 * fan_steps : fan_steps;  // far along a duct
  for (int i = 1; i <= steps; ++i) distances.push_back(farthest * i / steps);
  const std::vector<NearRay> places = rays.trace(elevations, distances);
  for (std::size_t i = 0; i < elevations.size(); ++i) {
    const double altitude_deg = to_deg(elevations[i]);
    FanRay ray{altitude_deg, fate_at(d.mirages.front(), altitude_deg), {0}, {d.height_m}};
    for (std::size_t k = 0; k < distances.size(); ++k) {
      const NearRay &at = places[i * distances.size() + k];
      const bool here = at.outcome == f64::RAY_IN_FLIGHT || at.outcome == f64::RAY_TRAPPED;
      const double before_m = ray.distance_m.back();
      ray.distance_m.push_back(here ? distances[k] : std::clamp(at.distance_m, before_m, distances[k]));
      ray.height_m.push_back(std::max(0.0, at.height_m));
      if (!here) break;
    }
    d.fan.push_back(std::move(ray));
  }
}

/// Where the ray that just clears the ground touches it: the place at which its neighbour below ends.
void find_horizon(NearRays &rays, ViewDiagnosis &d) {
  if (!d.flat) {
    const double r = d.earth_radius_m;
    d.geometric_horizon_deg = -to_deg(std::acos(r / (r + d.height_m)));
    d.geometric_horizon_m = horizon_distance_m(r, d.height_m, 0);
  }
  d.horizon_deg = horizon_of(d.mirages.front());
  if (!d.horizon_deg) return;
  for (const Branch &b : d.mirages.front().branches)
    if (b.low_end == BranchEnd::duct_edge && std::abs(b.low_deg - *d.horizon_deg) < 1e-6)
      return;  // it is endlessly far
  std::vector<double> distances;
  const double far_m = std::max(10 * d.geometric_horizon_m.value_or(1e5), 3e5);
  for (int i = 1; i <= 300; ++i) distances.push_back(far_m * i / 300);
  const NearRay end = rays.trace(std::vector<double>{to_rad(*d.horizon_deg) - 1e-9}, distances).back();
  if (end.outcome == f64::RAY_GROUND) d.horizon_m = end.distance_m;
}

}  // namespace

double structure_top_m(const Profile &profile, const Diagnosis &diagnosis, std::optional<double> eye_height_m) {
  constexpr double all_weather_m = 30000, low_m = 3000;  // soundings have small inversions all the way up
  const ProfileSpec &spec = profile.spec();
  if (!profile.is_air()) return std::max(spec.index_levels.back().height_m, eye_height_m.value_or(0) * 1.2);
  double highest = 0;
  const auto reach = [&](double h) {
    if (h < low_m) highest = std::max(highest, h);
  };
  for (const Duct &duct : diagnosis.ducts) reach(duct.top_m);
  for (const SuperadiabaticLayer &layer : diagnosis.superadiabatic) reach(layer.top_m);
  for (const InversionSpec &v : spec.inversions) reach(v.height_m.constant() + 5 * v.diffuseness_m.constant());
  for (const SurfaceLayerSpec &layer : spec.surface_layers) reach(6 * layer.scale_m);
  for (const Inversion &v : diagnosis.inversions)
    if (v.rise_K > 0.3 && !spec.levels.empty()) reach(v.top_m);
  const double top = highest > 0 ? 2 * highest : all_weather_m;
  return std::clamp(std::max(top, 1.2 * eye_height_m.value_or(0)), 0.1, us76::air_top_m);
}

ViewDiagnosis diagnose_view(const AirSection &air, const ViewRequest &request, const std::shared_ptr<Device> &device) {
  const Profile profile = air.at(0);
  ViewDiagnosis d;
  d.profile = air.spec().name, d.exaggerate = air.spec().exaggerate;
  d.height_m = request.height_m, d.earth_radius_m = air.spec().earth_radius_m;
  d.flat = request.flat, d.varies = request.section;
  d.air = diagnose(profile, request.height_m);
  d.top_m = std::min(structure_top_m(profile, d.air, request.height_m), profile.top_m(!profile.is_air()));
  d.rows = rows_of(profile, d.top_m);
  d.k_at_eye = ray_curvature(profile, std::min(request.height_m, profile.top_m(!profile.is_air())));

  const SkyRayOptions options = ray_options(request, *device);
  SkyRays rays = request.section ? SkyRays(air, request.wavelengths_nm, options, device)
                                 : SkyRays(profile, request.wavelengths_nm, options, device);
  d.mirages = find_mirages(rays, profile, mirage_options(request.section, options.precision == Precision::single_));
  d.fan_wavelength_nm = request.wavelengths_nm.front();
  NearRays near(air, request.height_m, d.fan_wavelength_nm, request.flat, request.section, request.azimuth_rad, device);
  find_horizon(near, d);
  trace_fan(near, request, air, d);
  if (request.target)
    d.sight = sight_line(near, request.target->distance_m, request.target->height_m,
                         request.section ? std::vector<double>{} : breaks_rad(rays.layers(), 0));
  return d;
}

}  // namespace greenray
