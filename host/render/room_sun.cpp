#include "render/room_sun.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "render/host_rays.hpp"
#include "render/sky.hpp"
#include "render/sun_place.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

constexpr int slices = 8;  // of the disk, for its mean

/// The scene of the sky above a room.
Scene sky_above(const RoomScene &scene, const LightScene &light) {
  Scene sky;
  sky.atmosphere = scene.above;
  sky.observer.height_m = light.site_height_m;
  return sky;
}

std::string degrees(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g deg", std::round(1e4 * value) / 1e4 + 0.0);
  return text;
}

[[noreturn]] void refuse_altitude(const LightScene &light, const std::string &why) {
  throw InputError(light.altitude_place, std::string(light.apparent ? "apparent_altitude_deg = " : "altitude_deg = ") +
                                             degrees(light.altitude_deg) + ": " + why);
}

/// Rays of one eye at 550 nm.
struct Rays {
  const IndexTable &table;
  double height_m;
  LayerAbsorbers shapes;
  Transfer trace(double elevation_rad) const {
    return transfer_of(trace_on_host(table, 0, height_m, elevation_rad, shapes), elevation_rad, table.curvature_per_m);
  }
};

/// Apparent altitude [rad] of the disk's centre; refused where it is not in the sky.
double apparent_rad(const LightScene &light, const HostRay &ray, const std::optional<double> &horizon) {
  const double given = to_rad(light.altitude_deg);
  const std::optional<double> seen = light.apparent ? given : apparent_altitude_rad(ray, given, horizon);
  if (seen && ray(*seen).outcome == f64::RAY_SPACE) return *seen;
  const double lowest = horizon.value_or(-pi / 2);
  const double bending = light.apparent ? 0 : ray(lowest).bending_rad;
  refuse_altitude(light, "the Sun is not in the sky there; expected an altitude above the horizon's, " +
                             degrees(to_deg(lowest - bending)));
}

}  // namespace

RoomSun sun_through_air(const RoomScene &scene, const LightScene &light, const std::vector<double> &wavelength_nm) {
  const Scene sky = sky_above(scene, light);
  const Profile profile(sky.atmosphere.profile);
  const bool flat = sky.atmosphere.surface == Surface::flat;
  const IndexTable table = build_index_table(profile, {550}, {flat, 1e-5, light.site_height_m});
  const HostRay ray_at = host_ray(table, 0, light.site_height_m);
  const std::optional<double> horizon = horizon_rad(ray_at);
  const Rays rays{table, light.site_height_m, {ozone_peak_m, ozone_width_m, sky.atmosphere.aerosol_scale_height_m}};
  const double seen = apparent_rad(light, ray_at, horizon);
  const Transfer centre = rays.trace(seen);
  const std::vector<SpectralAir> airs = spectral_air(sky, wavelength_nm);
  RoomSun sun;
  sun.apparent_altitude_deg = to_deg(seen), sun.true_altitude_deg = to_deg(centre.true_altitude_rad);
  const double zenith = profile.zenith_column_kg_m2(light.site_height_m);
  sun.air_mass = zenith > 0 ? centre.column[0] / zenith : 0;
  for (const SpectralAir &air : airs) sun.optical_depth.push_back(optical_depth(centre, air));
  sun.irradiance_W_m2_nm.resize(airs.size());
  // Slices of the disk of equal height, by Gauss's rule for chords (Chebyshev of the second kind); those below the
  // horizon send nothing.
  const double radius = std::min(from_arcsec(mean_sun_radius_arcsec), to_rad(light.diameter_deg / 2));
  for (int i = 1; i <= slices; ++i) {
    const double angle = pi * i / (slices + 1), share = 2 * std::pow(std::sin(angle), 2) / (slices + 1);
    const double altitude = std::min(centre.true_altitude_rad + radius * std::cos(angle), pi / 2);
    const auto at = apparent_altitude_rad(ray_at, altitude, horizon);
    if (!at) continue;
    const Transfer ray = rays.trace(*at);
    for (std::size_t w = 0; w < airs.size(); ++w)
      sun.irradiance_W_m2_nm[w] += share * airs[w].irradiance_outside(from_arcsec(mean_sun_radius_arcsec)) *
                                   std::exp(-optical_depth(ray, airs[w]));
  }
  if (!(*std::max_element(sun.irradiance_W_m2_nm.begin(), sun.irradiance_W_m2_nm.end()) > 1e-20))
    refuse_altitude(light, "no light of the Sun comes through this air");
  return sun;
}

std::vector<std::vector<double>> limb_rows(const std::vector<double> &wavelength_nm) {
  std::vector<std::vector<double>> rows;
  for (const SpectralAir &air : spectral_air(Scene{}, wavelength_nm)) {
    rows.resize(air.limb.size());
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k].push_back(air.limb[k] / air.limb_mean());
  }
  return rows;
}

const LightScene *sun_of(const RoomScene &scene) {
  const auto found =
      std::find_if(scene.lights.begin(), scene.lights.end(), [](const LightScene &light) { return light.through_air; });
  return found == scene.lights.end() ? nullptr : &*found;
}

}  // namespace greenray
