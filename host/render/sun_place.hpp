// Where the Sun of a scene stands, outside the air.
#pragma once
#include "render/host_rays.hpp"
#include "render/renderer.hpp"
#include "render/sky.hpp"

namespace greenray {

/// The air that is traced: the scene's, without bending or humidity where asked.
ProfileSpec spec_for(const Scene &scene, const RenderOptions &options);

/// Where the eye looks, clockwise from the direction of x [rad]: from the profile's azimuth_deg to the middle of the
/// picture; 0 for a profile that names no direction, whose path then runs where the eye looks.
double azimuth_from_path_rad(const Scene &scene);

/// Rays of the eye through a fine table at 550 nm, the wavelength at which altitudes of Sun and horizon are given.
HostRay reference_ray(const Scene &scene, const AirSection &air);

/// True altitude of what is seen at an apparent one, at 550 nm. Throws InputError at the key's place when light from
/// there does not come from the sky.
double true_from_apparent_rad(double apparent_rad, const std::string &key, const SourcePlace &place,
                              const HostRay &reference);

/// Throws InputError at the key when an apparent altitude is not in the sky.
SunPlace place_of_sun(const Scene &scene, const HostRay &reference);

}  // namespace greenray
