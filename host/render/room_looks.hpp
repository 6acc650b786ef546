// Materials, textures and lights of a scene by wavelength, as the device wants them.
#pragma once
#include <vector>

#include "compute/room_tracer.hpp"
#include "image/uplift.hpp"
#include "scene/room_scene.hpp"

namespace greenray {

/// Evenly spaced over the scene's range.
std::vector<double> room_wavelengths(const RoomScene &scene);

/* Spectra are normalised so that a light's power, samples joined by straight lines, is what the scene says; one
   wavelength is a band 1 nm wide. Lights without a colour are D65, a Sun without an irradiance is the Sun through the
   air above (render/room_sun.hpp). errors: InputError for a texture that cannot be read */
RoomLooks room_looks(const RoomScene &scene);

/// Shares out the photons of a pass by these weights of the lights: first_photon and photons of each.
void share_photons(RoomLooks &looks, std::uint32_t photons, const std::vector<double> &weights);
/// By their powers.
void share_photons(RoomLooks &looks, std::uint32_t photons);

}  // namespace greenray
