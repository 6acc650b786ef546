#include "scene/target_file.hpp"

#include <filesystem>

namespace greenray {
namespace {

namespace fs = std::filesystem;

constexpr Limits size_limits{0, 1e6, "m", true};

/// A number for grey, or [r, g, b].
void read_colour(const TomlTable &row, const std::string &key, std::array<double, 3> &into) {
  if (!row.holds_array(key)) {
    double grey = 0;
    if (row.read(key, grey, {0, 1})) into = {grey, grey, grey};
    return;
  }
  std::vector<double> rgb;
  if (!row.read(key, rgb, {0, 1})) return;
  if (rgb.size() != 3) return row.complain(key, "expected a number from 0 to 1, or [r, g, b]");
  std::copy(rgb.begin(), rgb.end(), into.begin());
}

/// Reflectance by day, or what shines by itself.
void read_light(const TomlTable &row, TargetScene &target) {
  const bool shines = row.has("luminance_cd_m2"), picture = target.kind == TargetScene::Kind::billboard;
  row.read("luminance_cd_m2", target.luminance_cd_m2, {0, 1e12, "cd/m2"});
  if (!shines && !picture) row.require("reflectance", "a number from 0 to 1 or [r, g, b]; or luminance_cd_m2");
  if (row.has("reflectance")) {
    read_colour(row, "reflectance", target.colour);
    if (shines) row.complain("reflectance", "expected reflectance or luminance_cd_m2, found both");
    if (picture) row.complain("reflectance", "expected none: the picture's colours are its reflectance");
  }
  if (row.has("colour")) {
    read_colour(row, "colour", target.colour);
    if (!shines || picture)
      row.complain("colour", picture ? "expected none: the picture has its own"
                                     : "expected luminance_cd_m2 beside it; what Sun and sky light has a reflectance");
  }
}

void read_picture(const TomlTable &row, const std::string &folder, TargetScene &target) {
  std::string name;
  row.require("picture", "the name of a .png or .exr file");
  if (!row.read("picture", name)) return;
  const std::string extension = fs::path(name).extension().string();
  target.picture = (fs::path(folder) / name).lexically_normal().string();
  if (extension != ".png" && extension != ".exr")
    row.complain("picture", "expected a picture that ends in .png or .exr, found \"" + name + "\"");
  else if (std::error_code ignored; !fs::is_regular_file(target.picture, ignored))
    row.complain("picture", "no such picture: '" + target.picture + "'");
}

void read_outline(const TomlTable &row, TargetScene &target) {
  row.require("outline_m", "corners [[across, up], ..] in metres, three at least");
  if (!row.read_pairs("outline_m", target.outline_m, {-1e6, 1e6, "m"})) return;
  if (target.outline_m.size() < 3 || target.outline_m.size() > 4096)
    row.complain("outline_m", "expected 3 to 4096 corners, found " + std::to_string(target.outline_m.size()));
}

TargetScene read_target(const TomlTable &row, const std::string &folder) {
  using Kind = TargetScene::Kind;
  TargetScene target;
  target.place = row.place();
  row.require("kind", "one of billboard, rectangle, triangle, polygon");
  row.read_word("kind", target.kind,
                {{"billboard", Kind::billboard},
                 {"rectangle", Kind::rectangle},
                 {"triangle", Kind::triangle},
                 {"polygon", Kind::polygon}});
  row.require("distance_m", "a number from 1 to 1e6 m, along the surface");
  row.read("distance_m", target.distance_m, {1, 1e6, "m"});
  row.read("azimuth_deg", target.azimuth_deg, {-360, 360, "deg"});
  row.read("offset_m", target.offset_m, {-1e6, 1e6, "m"});
  row.read("base_m", target.base_m, {-1e5, 1e5, "m"});
  if (target.kind == Kind::polygon) read_outline(row, target);
  else
    for (const auto &[key, into] : {std::pair{"width_m", &target.width_m}, std::pair{"height_m", &target.height_m}}) {
      row.require(key, size_limits.text());
      row.read(key, *into, size_limits);
    }
  if (target.kind == Kind::billboard) read_picture(row, folder, target);
  read_light(row, target);
  return target;
}

}  // namespace

void read_targets(const TomlTable &root, const std::string &folder, Scene &scene) {
  for (const TomlTable &row : root.rows("target")) scene.targets.push_back(read_target(row, folder));
}

void read_sea(const TomlTable &table, SeaScene &sea) {
  sea.rough = table.exists();
  table.require("wind_m_s", "a number from 0 to 60 m/s, 10 m above the water");
  table.read("wind_m_s", sea.wind_m_s, {0, 60, "m/s"});
  table.read("significant_height_m", sea.significant_height_m, {0, 30, "m"});
}

}  // namespace greenray
