// The keys of [eye], of skies and rooms alike.
#pragma once
#include "scene/scene.hpp"
#include "support/toml_reader.hpp"

namespace greenray {

void read_eye_scene(const TomlTable &table, EyeScene &eye);

}  // namespace greenray
