// Keys of a sky scene for terrain.
#pragma once
#include "scene/scene.hpp"
#include "support/toml_reader.hpp"

namespace greenray {

/// [terrain], and of [observer] what stands on it: place, above_ground_m. folder: of the scene file, where its tiles
/// lie. Call it after the observer's own keys are read.
void read_terrain(TomlDocument &document, const TomlTable &table, const TomlTable &observer, const std::string &folder,
                  Scene &scene);

}  // namespace greenray
