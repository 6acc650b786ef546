// Parts of parse_room that more than one file needs. Included by host/scene only.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/room_scene.hpp"
#include "support/toml_reader.hpp"

namespace greenray {

/// Which surfaces stand under a name, for lights that shine from them.
struct NamedSurfaces {
  std::vector<std::size_t> triangles, spheres;  // indices
};
using RoomNames = std::map<std::string, NamedSurfaces>;

/// [x, y, z]; returns true when it was there and right.
bool read_triple(const TomlTable &table, const std::string &key, Triple &into, const Limits &limits);

/// A number, or [r, g, b], each within the limits.
bool read_colour(const TomlTable &table, const std::string &key, Colour &into, const Limits &limits);

/// A file beside the scene, else one that ships under the same path; `name` as written.
struct FoundText {
  std::string path, text;
};
std::optional<FoundText> find_beside(const std::string &folder, const std::string &name, const SourcePlace &asked_at);

/// [[material]], [[mesh]], [[quad]], [[box]], [[sphere]] into scene.materials, textures and surfaces, and the lights
/// that MTL files make of their Ke.
RoomNames read_room_surfaces(TomlDocument &document, const TomlTable &root, const std::string &folder,
                             RoomScene &scene);

/// [[light]] into scene.lights; area lights mark their surfaces.
void read_room_lights(const TomlTable &root, const RoomNames &names, RoomScene &scene);

}  // namespace greenray
