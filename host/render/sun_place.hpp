// Where the Sun of a scene stands, outside the air.
#pragma once
#include "atmosphere/index_table.hpp"
#include "render/renderer.hpp"
#include "render/sky.hpp"

namespace greenray {

/// The air that is traced: the scene's, without bending or humidity where asked.
ProfileSpec spec_for(const Scene &scene, const RenderOptions &options);

/// A fine table at 550 nm, the wavelength at which altitudes of Sun and horizon are given.
IndexTable reference_table(const Scene &scene, const Profile &profile);

/// Throws InputError at the key when an apparent altitude is not in the sky.
SunPlace place_of_sun(const Scene &scene, const IndexTable &reference);

}  // namespace greenray
