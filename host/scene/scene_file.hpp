// Scene files: TOML text (docs/file-formats.md), with -D overrides, read and checked into a Scene.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.hpp"

namespace greenray {

/// The scene described by `text`, its profile loaded (relative to the folder of `file`) and checked too.
/// overrides: "sun.altitude_deg=-0.5", value in TOML syntax or a bare word; an override of one of two keys that exclude
/// each other (sun.altitude_deg, sun.apparent_altitude_deg) puts the other one of the file out of force.
/// errors: InputError with every complaint at once; those about an override stand at `-D KEY=VALUE:1:COLUMN`
Scene parse_scene(const std::string &file, std::string_view text, const std::vector<std::string> &overrides = {});

/// A scene file, or a shipped scene by its name without extension.
/// asked_at: where the name was given; default: line 1 of the file that is missing
/// errors: InputError when there is neither; as parse_scene otherwise
Scene load_scene(const std::string &name_or_file, const std::vector<std::string> &overrides = {},
                 const std::optional<SourcePlace> &asked_at = {});

/// Names of the shipped scenes, sorted; the template of `greenray new` is not among them.
std::vector<std::string> shipped_scenes();

/// 16 hex digits over everything that changes the picture: all values after overrides, and those of the profile.
/// Comments, title, sweeps, file names and the place of the output do not count.
/// differs: FNV-1a, 64 bits, over "key=value" lines with exact decimals; -0.0 counts as 0.0
std::string scene_hash(const Scene &scene);

}  // namespace greenray
