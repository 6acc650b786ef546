// Reads [moon] of a scene file.
#pragma once
#include "scene/moon_scene.hpp"
#include "support/toml_reader.hpp"

namespace greenray {

/// observer_height_m: for the Moon's parallax. Complaints go to the table's document.
void read_moon(const TomlTable &table, double observer_height_m, MoonScene &moon);

}  // namespace greenray
