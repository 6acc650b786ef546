#include "render/moon_place.hpp"

#include <cmath>

#include "render/sky_glow.hpp"
#include "render/sun_place.hpp"
#include "sky/earth_shadow.hpp"
#include "sky/moon.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

/// The Earth's limb: shells fine enough for every ray that grazes one of them.
AirShells limb(const Profile &air, const LayerAbsorbers &absorbers) {
  std::vector<double> heights;
  for (double h = 0; h < 30000; h += 250) heights.push_back(h);
  for (double h = 30000; h <= 120000; h += 1000) heights.push_back(h);
  return AirShells(layered_medium(air, false), 550, absorbers, heights);
}

/// Haze lies in the lowest air, through which no light comes to the Moon anyway; what is above the clouds is clear.
constexpr double share_of_haze = 0.01;

EarthShadow shadow_of(const Scene &scene, const std::vector<SpectralAir> &air,
                      const std::vector<double> &wavelength_nm) {
  SkyOptics optics = sky_optics(scene.atmosphere, air, wavelength_nm);
  for (float &haze : optics.aerosol_per_m) haze *= static_cast<float>(share_of_haze);
  const LayerAbsorbers absorbers{ozone_peak_m, ozone_width_m, scene.atmosphere.aerosol_scale_height_m};
  return EarthShadow(limb(Profile(ProfileSpec{}), absorbers), optics, from_arcsec(mean_sun_radius_arcsec));
}

constexpr double moon_radius_m = 1737.4e3;

}  // namespace

MoonPlace place_of_moon(const Scene &scene, const HostRay &reference, const std::vector<SpectralAir> &air,
                        const std::vector<double> &wavelength_nm) {
  const MoonScene &moon = scene.moon;
  MoonPlace place;
  if (moon.given == MoonScene::Given::nothing) return place;
  place.shines = true;
  place.radius_rad = to_rad(moon.diameter_arcmin / 120);
  place.true_altitude_rad = moon.given == MoonScene::Given::apparent_altitude
                                ? true_from_apparent_rad(to_rad(moon.altitude_deg), "moon.apparent_altitude_deg",
                                                         moon.altitude_place, reference)
                                : to_rad(moon.altitude_deg);
  const double azimuth = moon.azimuth_deg.value_or(scene.observer.azimuth_deg) - scene.observer.azimuth_deg;
  place.azimuth_rad = to_rad(azimuth - 360 * std::round(azimuth / 360));
  const double phase = to_rad(moon.phase_angle_deg), factor = lunar_phase_factor(phase);
  for (std::size_t w = 0; w < air.size(); ++w) {
    const double sun =
        air[w].irradiance_outside(from_arcsec(mean_sun_radius_arcsec)) / std::pow(moon.sun_distance_au, 2);
    place.radiance.push_back(sun / pi * lunar_albedo(wavelength_nm[w]) * factor);
    place.irradiance.push_back(place.radiance.back() * pi * place.radius_rad * place.radius_rad *
                               lommel_seeliger_phase(phase));
  }
  if (!moon.shadow_arcmin) return place;
  const EarthShadow shadow = shadow_of(scene, air, wavelength_nm);
  for (std::size_t i = 0; i < shadow.rows(); ++i) place.shadow.emplace_back(shadow.row(i), shadow.row(i) + air.size());
  // The Moon's own radius tells the scale: what is a kilometre there is an angle at the eye by its diameter.
  place.shadow_step_rad = shadow.step_m() / moon_radius_m * place.radius_rad;
  const double from_axis_m =
      std::hypot((*moon.shadow_arcmin)[0], (*moon.shadow_arcmin)[1]) / moon.diameter_arcmin * 2 * moon_radius_m;
  std::vector<float> share(shadow.padded());
  shadow.share(from_axis_m, share.data());  // of the middle for the whole: it lights the air, no more
  for (std::size_t w = 0; w < air.size(); ++w) place.irradiance[w] *= static_cast<double>(share[w]);
  return place;
}

f32::MoonView moon_view(const MoonScene &moon, const MoonPlace &place, double sun_altitude_rad) {
  f32::MoonView v{};
  if (!place.shines) return v;
  v.radius_rad = static_cast<float>(place.radius_rad);
  v.azimuth_rad = static_cast<float>(place.azimuth_rad);
  v.cos_altitude = static_cast<float>(std::cos(place.true_altitude_rad));
  v.above_sun = static_cast<float>(place.true_altitude_rad - sun_altitude_rad);
  const double phase = to_rad(moon.phase_angle_deg), limb_rad = to_rad(moon.bright_limb_deg);
  v.sun_right = static_cast<float>(std::sin(phase) * std::sin(limb_rad));
  v.sun_up = static_cast<float>(std::sin(phase) * std::cos(limb_rad));
  v.sun_towards = static_cast<float>(std::cos(phase));
  v.shadow_rows = static_cast<int>(place.shadow.size());
  if (place.shadow.empty()) return v;
  v.shadow_right = static_cast<float>(2 * (*moon.shadow_arcmin)[0] / moon.diameter_arcmin);
  v.shadow_up = static_cast<float>(2 * (*moon.shadow_arcmin)[1] / moon.diameter_arcmin);
  v.shadow_rows_per_radius = static_cast<float>(place.radius_rad / place.shadow_step_rad);
  return v;
}

}  // namespace greenray
