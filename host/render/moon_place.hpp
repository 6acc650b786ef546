// Where the Moon of a scene stands, how bright it is, and the Earth's shadow on it.
#pragma once
#include "render/host_rays.hpp"
#include "render/renderer.hpp"
#include "render/spectrum.hpp"
#include "scene/scene.hpp"

namespace greenray {

struct MoonPlace {
  bool shines = false;
  double true_altitude_rad = 0;  // of its centre, outside the air
  double azimuth_rad = 0;        // from the picture's centre
  double radius_rad = 0;
  std::vector<double> radiance;            // [wavelengths], where 2 mu0/(mu0 + mu) = 1
  std::vector<std::vector<float>> shadow;  // [distances from the axis][wavelengths]; empty: no eclipse
  double shadow_step_rad = 0;              // between them, as an angle at the eye
  std::vector<double> irradiance;          // [wavelengths] of the whole disk on a surface that faces it
};

/* The Moon by [moon]. An eclipse is lit through US76's clear air at the limb with the scene's ozone and a hundredth of
   its aerosol's, which is the air of a whole ring of the Earth and not the air over the eye. errors: InputError at the
   key when an apparent altitude is not in the sky */
MoonPlace place_of_moon(const Scene &scene, const HostRay &reference, const std::vector<SpectralAir> &air,
                        const std::vector<double> &wavelength_nm);

/// What the kernel is told. sun_altitude_rad: true, that its table counts from.
f32::MoonView moon_view(const MoonScene &moon, const MoonPlace &place, double sun_altitude_rad);

}  // namespace greenray
