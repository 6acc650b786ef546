#include "render/sky.hpp"

#include <cmath>

#include "support/angle.hpp"

namespace greenray {
namespace {

/// Optical depths of one ray at one wavelength.
struct Depth {
  double rayleigh, aerosol, ozone;
  double total() const { return rayleigh + aerosol + ozone; }
};

Depth depth_of(const Transfer &ray, const SpectralAir &air) {
  return {ray.column[0] * air.rayleigh_per_kg_m2, ray.column[2] * air.aerosol_per_m, ray.column[1] * air.ozone_per_m};
}

/// Radiance in two parts: what does not depend on the angle from the Sun, and the factor of the aerosol's phase
/// function.
struct Glow {
  double isotropic, aureole;
};

/// J (1 - exp(-tau)) with the shares of what scatters.
Glow scattered(const Depth &depth, double sunlight) {
  const double tau = depth.total();
  if (tau <= 0) return {0, 0};
  const double filled = -std::expm1(-tau) / tau;
  return {sunlight * filled * depth.rayleigh / (4 * pi), sunlight * filled * depth.aerosol};
}

class SkyMaker {
 public:
  explicit SkyMaker(const SkyLight &light) : light_(light), sun_(light.sun) {}

  /// The five channels of one ray but for SKY_JOINED.
  std::array<double, 4> channels(const Transfer &ray, std::size_t wave) const {
    const SpectralAir &air = light_.air[wave];
    const double from_sun = ray.true_altitude_rad - sun_.true_altitude_rad;
    if (light_.sky.model == SkyScene::Model::academic)
      return {from_sun, ray.outcome == f64::RAY_SPACE && sun_.shines ? air.sun_centre_radiance : 0, 0, 0};
    const Depth depth = depth_of(ray, air);
    const double sunlight = sunlight_on_air(wave);
    Glow glow = scattered(depth, sunlight);
    if (ray.outcome != f64::RAY_SPACE) {
      const Glow mirrored = scattered(depth_of(light_.at_10_degrees[wave], air), sunlight);
      const double share = light_.sky.sea_reflectance * std::exp(-depth.total());
      glow.isotropic += share * mirrored.isotropic;
      glow.aureole += share * mirrored.aureole;
      return {from_sun, 0, glow.isotropic, glow.aureole};
    }
    const double seen = sun_.shines ? air.sun_centre_radiance * std::exp(-depth.total()) : 0;
    return {from_sun, seen, glow.isotropic, glow.aureole};
  }

  PathLight path(const Transfer &ray, std::size_t wave) const {
    if (light_.sky.model == SkyScene::Model::academic) return {1, 0, 0};
    const Depth depth = depth_of(ray, light_.air[wave]);
    const Glow glow = scattered(depth, sunlight_on_air(wave));
    return {std::exp(-depth.total()), glow.isotropic, glow.aureole};
  }

  double on_upright(double azimuth_rad, std::size_t wave) const {
    const SpectralAir &air = light_.air[wave];
    const Transfer &ray = light_.towards_sun[wave];
    const double altitude = sun_.true_altitude_rad;
    const double facing = -std::cos(altitude) * std::cos(sun_.azimuth_rad - azimuth_rad);
    const bool direct = sun_.shines && facing > 0 && ray.outcome == f64::RAY_SPACE &&
                        std::abs(ray.true_altitude_rad - altitude) < sun_.radius_rad;
    const double sun =
        direct ? facing * air.irradiance_outside(sun_.radius_rad) * std::exp(-depth_of(ray, air).total()) : 0;
    const Glow sky = scattered(depth_of(light_.at_10_degrees[wave], air), sunlight_on_air(wave));
    const double radiance = sky.isotropic + sky.aureole / (4 * pi);  // the aureole spread over all directions
    return sun + 0.5 * pi * radiance * (1 + light_.sky.sea_reflectance);
  }

 private:
  /// Irradiance on the air the eye looks through. Air and haze pass light on by many scatterings (two-stream,
  /// conservative: 1/(1 + 3/4 tau (1-g))), ozone absorbs it; below the horizon it falls by a factor 2.8 a degree, as
  /// twilight does.
  double sunlight_on_air(std::size_t wave) const {
    const SpectralAir &air = light_.air[wave];
    const double outside = air.irradiance_outside(sun_.radius_rad);
    const Transfer &ray = light_.towards_sun[wave];
    const Depth depth = depth_of(ray, air);
    const double passed = 1 / (1 + 0.75 * (depth.rayleigh + (1 - aerosol_asymmetry) * depth.aerosol));
    const double set_deg = std::max(0.0, to_deg(ray.true_altitude_rad - sun_.true_altitude_rad) - 0.3);
    return outside * passed * std::exp(-depth.ozone) * std::pow(10, -0.45 * set_deg);
  }

  const SkyLight &light_;
  const SunPlace &sun_;
};

}  // namespace

double optical_depth(const Transfer &ray, const SpectralAir &air) { return depth_of(ray, air).total(); }

PathLight light_of_path(const SkyLight &light, const Transfer &ray, std::size_t wave) {
  return SkyMaker(light).path(ray, wave);
}
double irradiance_on_upright(const SkyLight &light, double azimuth_rad, std::size_t wave) {
  return SkyMaker(light).on_upright(azimuth_rad, wave);
}

SkyTable make_sky_table(const SkyLight &light, const TransferTable &transfer, int waves) {
  const SkyMaker maker(light);
  const std::vector<SpectralAir> &air = light.air;
  const auto padded = static_cast<std::size_t>(waves);
  SkyTable table;
  table.entries = static_cast<int>(transfer.entries);
  table.waves = waves;
  table.values.assign(transfer.entries * f32::SKY_CHANNEL_COUNT * padded, 0.0f);
  table.limb.assign(air.front().limb.size() * padded, 0.0f);
  for (std::size_t w = 0; w < air.size(); ++w)
    for (std::size_t k = 0; k < air[w].limb.size(); ++k)
      table.limb[k * padded + w] = static_cast<float>(air[w].limb[k]);
  for (std::size_t e = 0; e < transfer.entries; ++e)
    for (std::size_t w = 0; w < air.size(); ++w) {
      float *at = &table.values[e * f32::SKY_CHANNEL_COUNT * padded + w];
      const std::array<double, 4> channels = maker.channels(transfer.at(e, w), w);
      for (std::size_t c = 0; c < channels.size(); ++c) at[c * padded] = static_cast<float>(channels[c]);
      at[f32::SKY_JOINED * padded] = transfer.edges.empty() ? 1.0f : transfer.edges[e * air.size() + w];
    }
  return table;
}

}  // namespace greenray
