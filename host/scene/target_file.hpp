// Keys of a sky scene for what stands before the sky.
#pragma once
#include "scene/scene.hpp"
#include "support/toml_reader.hpp"

namespace greenray {

/// [[target]] into scene.targets. folder: of the scene file, where its pictures lie.
void read_targets(const TomlTable &root, const std::string &folder, Scene &scene);

/// A reflectance or a colour: a number for grey, or [r, g, b], each from 0 to 1.
void read_colour(const TomlTable &row, const std::string &key, std::array<double, 3> &into);

/// [sea]
void read_sea(const TomlTable &table, SeaScene &sea);

}  // namespace greenray
