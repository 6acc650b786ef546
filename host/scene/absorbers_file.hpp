// Keys of [atmosphere] for what dims the Sun, the same in scenes of the sky and of rooms.
#pragma once
#include "scene/scene.hpp"
#include "support/toml_reader.hpp"

namespace greenray {

/// extinction, ozone_DU, aerosol = { visibility_km | turbidity, angstrom, scale_height_m }
void read_absorbers(const TomlTable &atmosphere, AtmosphereScene &air);

}  // namespace greenray
