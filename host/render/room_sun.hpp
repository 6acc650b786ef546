// The Sun of a room: its own spectrum, dimmed, reddened and bent by the air above the scene.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "scene/room_scene.hpp"

namespace greenray {

struct RoomSun {
  double true_altitude_deg = 0, apparent_altitude_deg = 0;  // of its centre, at 550 nm
  double air_mass = 0;                     // column of air along the bent path, over that to the zenith
  std::vector<double> optical_depth;       // [wavelengths] along that path: Rayleigh, ozone and aerosol
  std::vector<double> irradiance_W_m2_nm;  // [wavelengths] on a surface that faces the Sun, at z = 0: mean of the disk
};

/* From E-490's irradiance outside the air by Beer and Lambert's law along rays from eight slices of the disk at 550 nm,
   through the same air as pictures of the sky. The disk stays round; one that is larger than the Sun's sends no more.
   light: kind sun, through_air
   errors: InputError at its altitude where the Sun is not in the sky, or no light comes through */
RoomSun sun_through_air(const RoomScene &scene, const LightScene &light, const std::vector<double> &wavelength_nm);

/// Powers of mu of its limb darkening over the disk's mean at each wavelength: [6][wavelengths] (Neckel & Labs 1994).
std::vector<std::vector<double>> limb_rows(const std::vector<double> &wavelength_nm);

/// The first light that shines through the air; nullptr: none.
const LightScene *sun_of(const RoomScene &scene);

}  // namespace greenray
