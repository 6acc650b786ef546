// Radiance of sky, sea and Sun for each entry of the transfer table.
#pragma once
#include <memory>

#include "compute/sky_shader.hpp"
#include "render/moon_place.hpp"
#include "render/sky_glow.hpp"
#include "render/spectrum.hpp"
#include "render/transfer.hpp"
#include "scene/scene.hpp"

namespace greenray {

/// The Sun's place, or, where it does not shine, that of the Moon in its stead; resolved: centre, true altitude
/// (outside the air), azimuth from the picture's centre.
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
  std::vector<Transfer> towards_sun;         // [wavelengths]
  std::vector<SpectralAir> air;              // [wavelengths]
  std::shared_ptr<const SkyGlow> glow = {};  // null: black (academic, or neither Sun nor Moon)
  std::vector<double> irradiance = {};       // [wavelengths] of what lights the sky, outside the air
  MoonPlace moon = {};
  std::vector<SkyGlow::AirBefore> air_before = {};  // by station of the targets; none: black
};

/// The Sun's disk through the extinction of each ray's own columns, and the light of sky and sea (SkyGlow) where the
/// ray comes from. The academic sky (G04 figures 6.2, 6.3) is black, its Sun a white disk outside the air.
SkyTable make_sky_table(const SkyLight &light, const TransferTable &transfer, int waves);

/// The part of a view that tells how to look `glow` up; null: nothing to look up.
void set_azimuths(const SkyGlow *glow, f32::SkyView &view);

/// Optical depth of a ray: Rayleigh, aerosol and ozone together.
double optical_depth(const Transfer &ray, const SpectralAir &air);

/// Light along paths to places at one distance along the surface: the share of a place's light that passes, and the
/// light of the air before it, of which `aureole` is to be multiplied by the aerosol's phase function.
struct PathLight {
  double passed, isotropic, aureole;
};
/// ray: columns up to there, and where it was sent (bending, and direction there). air: up to there; null: black.
PathLight light_of_path(const SkyLight &light, const Transfer &ray, const SkyGlow::AirBefore *air, std::size_t wave);

/// Irradiance [W m^-2 nm^-1] on an upright white surface at sea level that faces the eye from an azimuth (from the
/// picture's centre): the Sun as the air leaves it, sky and sea by their mean light and its flux (DiffuseLight).
double irradiance_on_upright(const SkyLight &light, double azimuth_rad, std::size_t wave);

/// Irradiance [W m^-2 nm^-1] on what faces the Sun at sea level, and on the level ground by the sky.
struct GroundLight {
  double sun, sky;
};
GroundLight light_on_ground(const SkyLight &light, std::size_t wave);

}  // namespace greenray
