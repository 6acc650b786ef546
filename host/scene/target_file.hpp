// Keys of a sky scene for what stands before the sky.
#pragma once
#include "scene/scene.hpp"
#include "support/toml_reader.hpp"

namespace greenray {

/// [[target]] into scene.targets. folder: of the scene file, where its pictures lie.
void read_targets(const TomlTable &root, const std::string &folder, Scene &scene);

/// [sea]
void read_sea(const TomlTable &table, SeaScene &sea);

}  // namespace greenray
