#include "scene/terrain_file.hpp"

#include <cmath>
#include <filesystem>

#include "scene/target_file.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;

bool read_place(const TomlTable &observer, GeoPlace &place) {
  const TomlTable table = observer.table("place");
  if (!table.exists()) return false;
  const bool north = table.require("latitude_deg", "a number from -90 to 90 deg") &&
                     table.read("latitude_deg", place.latitude_deg, {-90, 90, "deg"});
  const bool east = table.require("longitude_deg", "a number from -180 to 360 deg, east positive") &&
                    table.read("longitude_deg", place.longitude_deg, {-180, 360, "deg"});
  return north && east;
}

/// Every file named; complaints about one do not keep the others from being looked at.
std::vector<HeightTile> read_tiles(TomlDocument &document, const TomlTable &table, const std::string &folder) {
  std::vector<HeightTile> tiles;
  std::vector<std::string> names;
  if (!table.require("tiles", "names of .hgt or .tif files: [\"N46E007.hgt\", ..]") || !table.read("tiles", names))
    return tiles;
  if (names.empty()) table.complain("tiles", "expected one file at least");
  for (const std::string &name : names) try {
      tiles.push_back(read_height_tile((fs::path(folder) / name).lexically_normal().string(), table.place("tiles")));
    } catch (const InputError &error) {
      document.complain(error);
    }
  return tiles.size() == names.size() ? std::move(tiles) : std::vector<HeightTile>{};
}

/// Ground under the eye, and an eye that stands on it or looks out above it.
void place_eye(const TomlTable &observer, Scene &scene) {
  TerrainScene &terrain = scene.terrain;
  float ground = 0;
  std::size_t hint = 0;
  const HeightField::Cover cover = terrain.field->height(terrain.eye, ground, hint);
  if (cover == HeightField::Cover::void_)
    return observer.complain("place", "expected a place whose terrain is known: its tile has no height there");
  if (cover == HeightField::Cover::none && !terrain.missing_is_sea)
    return observer.complain(
        "place", "expected a place on one of terrain.tiles: none of them has " + degree_square(terrain.eye) + " there");
  terrain.ground_m = std::max(0.0f, ground);
  double above = 0;
  if (observer.read("above_ground_m", above, {0, 1e5, "m"})) {
    if (observer.has("height_m"))
      observer.complain("above_ground_m", "expected height_m (above the sea) or above_ground_m, found both");
    scene.observer.height_m = terrain.ground_m + above;
  } else if (scene.observer.height_m < terrain.ground_m) {
    observer.complain("height_m", "the eye would stand below the terrain, which is " +
                                      std::to_string(std::lround(terrain.ground_m)) +
                                      " m above the sea there: expected more, or above_ground_m");
  }
}

}  // namespace

void read_terrain(TomlDocument &document, const TomlTable &table, const TomlTable &observer, const std::string &folder,
                  Scene &scene) {
  TerrainScene &terrain = scene.terrain;
  const bool placed = read_place(observer, terrain.eye);
  if (!table.exists()) {
    for (const char *key : {"place", "above_ground_m"})
      if (observer.has(key))
        observer.complain(key, "expected [terrain] beside it: without it the eye is above the sea");
    return;
  }
  terrain.place = table.place();
  table.read("farthest_m", terrain.farthest_m, {100, 1e6, "m"});
  table.read_word("missing", terrain.missing_is_sea, {{"error", false}, {"sea", true}});
  read_colour(table, "reflectance", terrain.reflectance);
  std::vector<HeightTile> tiles = read_tiles(document, table, folder);
  if (!observer.has("place"))
    observer.complain("place", "expected { latitude_deg = .., longitude_deg = .. } with [terrain]");
  if (scene.tracing.transfer == TracingScene::Transfer::per_pixel)
    table.complain("tiles", "terrain is not seen with tracing.transfer = \"per-pixel\": expected \"table\"");
  if (scene.atmosphere.surface == Surface::flat)
    table.complain("tiles", "expected atmosphere.surface = \"sphere\" with terrain");
  if (tiles.empty() || !placed) return;
  terrain.field = std::make_shared<const HeightField>(std::move(tiles));
  place_eye(observer, scene);
}

}  // namespace greenray
