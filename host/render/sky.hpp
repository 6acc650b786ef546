// Radiance of sky, sea and Sun for each entry of the transfer table.
#pragma once
#include "compute/sky_shader.hpp"
#include "render/spectrum.hpp"
#include "render/transfer.hpp"
#include "scene/scene.hpp"

namespace greenray {

/// The Sun's place, resolved: centre, true altitude (outside the air), azimuth from the picture's centre.
struct SunPlace {
  bool shines = false;
  double true_altitude_rad = 0;
  double azimuth_rad = 0;
  double radius_rad = 0;
};

/// All that lights a picture of the sky but for the rays of sight.
struct SkyLight {
  SkyScene sky;
  SunPlace sun;
  std::vector<Transfer> towards_sun, at_10_degrees;  // [wavelengths]: the rays that light air and sea
  std::vector<SpectralAir> air;                      // [wavelengths]
};

/// The plain sky: one scattering with a source that is constant along the path, so that it is right in colour and
/// continuous at the horizon, not in absolute radiance (docs/method.md, "The plain sky").
///   sky  J (1 - exp(-tau)),  J = E_sun T (rayleigh share / 4 pi + aerosol share x phase)
///   sea  reflectance x sky at 10 degrees, seen through the air between, plus the light that air scatters in
/// The academic sky (G04 figures 6.2, 6.3) is black, its Sun a white disk outside the air.
SkyTable make_sky_table(const SkyLight &light, const TransferTable &transfer, int waves);

/// Optical depth of a ray: Rayleigh, aerosol and ozone together.
double optical_depth(const Transfer &ray, const SpectralAir &air);

/// Light along a path that ends at something: the share of its light that passes, and the light of the air before it,
/// of which `aureole` is to be multiplied by the aerosol's phase function. ray: columns up to there.
struct PathLight {
  double passed, isotropic, aureole;
};
PathLight light_of_path(const SkyLight &light, const Transfer &ray, std::size_t wave);

/// Irradiance [W m^-2 nm^-1] on an upright white surface that faces the eye from an azimuth (from the picture's
/// centre): the Sun as the air leaves it, and half a sky and half a sea as bright as those at 10 degrees.
double irradiance_on_upright(const SkyLight &light, double azimuth_rad, std::size_t wave);

inline constexpr double aerosol_asymmetry = 0.76;

}  // namespace greenray
