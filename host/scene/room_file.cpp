// A scene with surfaces from its TOML text: everything but the surfaces themselves (room_surfaces.cpp).
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "atmosphere/profile_file.hpp"
#include "scene/absorbers_file.hpp"
#include "scene/eye_file.hpp"
#include "scene/room_reader.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;

void read_header(const TomlTable &root, RoomScene &scene) {
  int version = 1;
  const char *expected = "1, the version of the scene format";
  if (root.require("greenray", expected) && root.read("greenray", version, {0, 1e9}) && version != 1)
    root.complain("greenray", std::string("expected ") + expected + ", found " + std::to_string(version));
  root.read("title", scene.title);
}

/// field = { kind = "layers", axis = "z", height_m = [..], temperature_C = [..] | temperature_K | refractivity }
void read_field(const TomlTable &field, ProfileSpec &air) {
  int only = 0;  // one word each, so far
  field.read_word("kind", only, {{"layers", 0}});
  field.read_word("axis", only, {{"z", 0}});
  std::vector<double> height_m, value;
  if (!field.require("height_m", "heights in m, ascending") || !field.read("height_m", height_m, {0, 1.2e5, "m"}))
    return;
  const std::pair<const char *, Limits> kinds[] = {
      {"temperature_C", {-200, 3000, "deg C"}}, {"temperature_K", {50, 3300, "K"}}, {"refractivity", {-0.9, 10}}};
  std::string key;
  bool is_told = false;
  for (const auto &[name, limits] : kinds) {
    std::vector<double> found;
    is_told |= field.has(name);
    if (!field.read(name, found, limits)) continue;
    if (!key.empty())
      field.complain(name, "expected one of temperature_C, temperature_K and refractivity, found " + key + " too");
    key = name, value = found;
  }
  if (key.empty()) {
    if (is_told) return;  // and found wrong
    field.require("temperature_C", "temperatures (or temperature_K, or refractivity), one for each height");
    return;
  }
  if (value.size() != height_m.size() || height_m.empty())
    return field.complain(key, "expected as many values as there are heights, " + std::to_string(height_m.size()) +
                                   ", found " + std::to_string(value.size()));
  for (std::size_t i = 1; i < height_m.size(); ++i)
    if (!(height_m[i] > height_m[i - 1])) return field.complain("height_m", "expected ascending heights");
  air.name = "layers";
  air.base_is_us76 = false;
  for (std::size_t i = 0; i < height_m.size(); ++i) {
    if (key == "refractivity") air.index_levels.push_back({height_m[i], value[i], field.place("height_m")});
    else
      air.levels.push_back(
          {height_m[i], value[i] + (key == "temperature_C" ? 273.15 : 0), {}, {}, field.place("height_m")});
  }
}

/// [atmosphere]; without it, or without a profile and a field, n is 1 everywhere.
void read_air(TomlDocument &document, const TomlTable &table, const std::string &folder, RoomScene &scene) {
  Surface surface = Surface::flat;
  if (table.read_word("surface", surface, {{"sphere", Surface::sphere}, {"flat", Surface::flat}}) &&
      surface == Surface::sphere)
    table.complain("surface", "a scene with a [camera] is flat: expected \"flat\"");
  table.read("extinction_per_m", scene.extinction_per_m, {0, 1e6, "1/m"});
  const bool has_profile = table.has("profile"), has_field = table.has("field");
  if (has_profile && has_field) table.complain("field", "expected either profile or field, found both");
  ProfileSpec air;
  air.place = table.place();
  std::string source;
  if (table.read("profile", source)) {
    try {
      air = load_profile(source, folder, table.place("profile"));
    } catch (const InputError &error) {
      document.complain(error);
    }
  }
  if (has_field) read_field(table.table("field"), air);
  double exaggerate = 1;
  table.read_word("dispersion", air.index, index_model_words());
  if (table.read("exaggerate", exaggerate, {0, 1e6, "", true})) air.exaggerate *= exaggerate;
  read_absorbers(table, scene.above);
  scene.above_is_medium = has_profile && !has_field && air.index_levels.empty();
  if (scene.above_is_medium) scene.above.profile = air, scene.above.profile.exaggerate = 1;
  else scene.above.profile.index = air.index;
  scene.above.profile_source = scene.above.profile.name;
  if (has_profile || has_field) scene.air = air;
  else if (table.has("exaggerate"))
    table.complain("exaggerate", "there is no medium to exaggerate: expected a profile or a field beside it");
}

void read_camera(const TomlTable &table, CameraScene &camera) {
  read_triple(table, "from", camera.from, {-1e6, 1e6, "m"});
  read_triple(table, "to", camera.to, {-1e6, 1e6, "m"});
  read_triple(table, "up", camera.up, {-1e6, 1e6});
  table.require("from", "a place, [x, y, z] in m");
  table.require("to", "a place to look at, [x, y, z] in m");
  const Triple ahead = camera.to - camera.from;
  if (length(ahead) == 0) table.complain("to", "expected a place other than `from`");
  else if (length(cross(ahead, camera.up)) < 1e-9 * length(ahead) * length(camera.up) || length(camera.up) == 0)
    table.complain(table.has("up") ? "up" : "to",
                   "expected an up direction that is not the direction of view: give camera.up");
  table.read("fov_deg", camera.fov_deg, {0, 170, "deg", true});
  std::vector<double> size;
  if (!table.read("resolution", size, {1, 16384, "pixels"})) return;
  if (size.size() != 2 || size[0] != std::floor(size[0]) || size[1] != std::floor(size[1]))
    return table.complain("resolution", "expected [width, height], two whole numbers of pixels");
  camera.resolution = {static_cast<int>(size[0]), static_cast<int>(size[1])};
}

void read_photons(const TomlTable &table, PhotonScene &photons) {
  double emitted = static_cast<double>(photons.emitted);
  if (table.read("emitted", emitted, {1, 1e12, "photons"})) {
    if (emitted != std::floor(emitted)) table.complain("emitted", "expected a whole number of photons");
    photons.emitted = static_cast<std::int64_t>(emitted);
  }
  table.read("gather", photons.gather, {1, 100000, "photons"});
  table.read("radius_m", photons.radius_m, {0, 1e6, "m", true});
  table.read("max_bounces", photons.most_bounces, {0, 60000, "bounces"});
  table.read("aimed", photons.aimed);
  table.read("precomputed", photons.precomputed, {0, 1000, "photons"});
  table.read("caustic_share", photons.caustic_share, {0.01, 0.9});
}

void read_rest(const TomlTable &root, RoomScene &scene) {
  const TomlTable spectrum = root.table("spectrum");
  spectrum.read("samples", scene.spectrum.samples, {1, 64});
  std::vector<double> range;
  if (spectrum.read("range_nm", range, {360, 830, "nm"})) {
    if (range.size() != 2 || !(scene.spectrum.samples == 1 ? range[0] <= range[1] : range[0] < range[1]))
      spectrum.complain("range_nm", "expected [from, to] in nm, from below to (or the same with samples = 1)");
    else scene.spectrum.range_nm = {range[0], range[1]};
  }
  read_eye_scene(root.table("eye"), scene.eye);
  const TomlTable output = root.table("output");
  output.read("image", scene.output.image);
  output.read("spectral", scene.output.spectral);
  if (!scene.output.image.empty() && fs::path(scene.output.image).extension() != ".exr")
    output.complain("image", "expected a file name that ends in .exr, found \"" + scene.output.image + "\"");
  double shown = 0;
  if (output.read("photon_map", shown, {0, 1e9, "photons"})) scene.photon_map = std::llround(shown);
  output.read("aovs", scene.aovs, {"depth", "photon_count", "bend_mrad", "noise"});
}

}  // namespace

bool is_room_text(const std::string &file, std::string_view text) {
  try {
    TomlDocument document(file, text);
    const TomlTable root = document.root();
    return root.has("camera") || root.has("mesh") || root.has("light") || root.has("photons");
  } catch (const InputError &) {
    return false;  // whoever reads it next says what is wrong
  }
}

RoomScene parse_room(const std::string &file, std::string_view text, const std::vector<std::string> &overrides) {
  TomlDocument document(file, text);
  for (const std::string &assignment : overrides) document.override_with(assignment);
  document.prefer_overridden("atmosphere.aerosol", "visibility_km", "turbidity");
  const TomlTable root = document.root();
  RoomScene scene;
  scene.name = fs::path(file).stem().string();
  scene.file = file;
  scene.text = std::string(text);
  scene.overrides = overrides;
  read_header(root, scene);
  const std::string folder = fs::path(file).parent_path().string();
  read_air(document, root.table("atmosphere"), folder, scene);
  root.require("camera", "a table [camera] with from and to");
  if (root.has("camera")) read_camera(root.table("camera"), scene.camera);
  const RoomNames names = read_room_surfaces(document, root, folder, scene);
  read_room_lights(root, names, scene);
  read_photons(root.table("photons"), scene.photons);
  read_rest(root, scene);
  scene.sweeps = read_sweeps(document, root);
  document.finish();
  scene.values = document.values();
  return scene;
}

}  // namespace greenray
