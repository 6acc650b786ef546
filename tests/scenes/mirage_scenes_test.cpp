// The shipped scenes of mirages: folds, vanishing lines, hidden heights and numbers of images, measured in their
// pictures.
#include <gtest/gtest.h>

#include <cmath>

#include "render/renderer.hpp"
#include "scene/scene_file.hpp"
#include "support/angle.hpp"
#include "support_code/reference_table.hpp"

namespace greenray {
namespace {

using testing_data::ReferenceRow;
using testing_data::ReferenceTable;

/// Heights by altitude in the middle column of a shipped scene's picture, on a wall that stands in place of its
/// targets.
struct Column {
  std::vector<double> altitude_deg, height_m;  // upwards; height -1: the wall is not seen

  static Column of(const std::string &scene_and_air) {
    const std::size_t blank = scene_and_air.find(' ');
    std::vector<std::string> keys{"spectrum.samples=1", "spectrum.range_nm=[550.0, 550.0]"};
    if (blank != std::string::npos) keys.push_back("atmosphere.profile=" + scene_and_air.substr(blank + 1));
    Scene scene = load_scene(scene_and_air.substr(0, blank), keys);
    const double distance_m = nearest_m(scene);
    scene.targets.resize(1);
    TargetScene &wall = scene.targets.front();
    wall = {};
    wall.distance_m = distance_m, wall.width_m = 2000, wall.height_m = 2000, wall.luminance_cd_m2 = 1;
    scene.sea = {};
    RenderOptions options;
    options.spp = 1;
    const int width = scene.observer.resolution[0], height = scene.observer.resolution[1];
    options.crop = {width / 2, 0, width / 2 + 1, height};
    static const std::shared_ptr<Device> device = open_device({});
    const SpectralImage image = render(scene, plan_render(scene, options), options, device).image;
    const double pixel = 2 * std::tan(to_rad(scene.observer.fov_deg) / 2) / width;
    Column column;
    for (int y = height - 1; y >= 0; --y) {
      column.altitude_deg.push_back(scene.observer.altitude_deg + to_deg(std::atan((height / 2.0 - y - 0.5) * pixel)));
      const auto at = static_cast<std::size_t>(y);
      const bool met = image.channels.at("target_distance_m")[at] > 0;
      column.height_m.push_back(met ? static_cast<double>(image.channels.at("target_height_m")[at]) : -1);
    }
    return column;
  }

  /// Of the targets that the scene's comment is about.
  static double nearest_m(const Scene &scene) {
    double nearest = 1e9;
    for (const TargetScene &target : scene.targets) nearest = std::min(nearest, target.distance_m);
    return nearest;
  }

  bool seen(std::size_t i) const { return height_m[i] >= 0; }

  int images_of(double height) const {
    int images = 0;
    for (std::size_t i = 1; i < height_m.size(); ++i)
      images += seen(i - 1) && seen(i) && (height_m[i - 1] < height) != (height_m[i] < height);
    return images;
  }

  /// The fold nearest to an altitude, as the middle of the highest (sign 1) or lowest pixels within 0.03 degree.
  double fold_deg(double near_deg, int sign, double &height) const {
    double best = -1e9, at = NAN;
    for (std::size_t i = 0; i < height_m.size(); ++i)
      if (seen(i) && std::abs(altitude_deg[i] - near_deg) < 0.03 && sign * height_m[i] > best)
        best = sign * height_m[i], at = altitude_deg[i];
    height = sign * best;
    return at;
  }

  double begins_deg(double &height) const {
    for (std::size_t i = 0; i < height_m.size(); ++i)
      if (seen(i)) return height = height_m[i], altitude_deg[i];
    return NAN;
  }
};

}  // namespace

// oracle: reference/mirage_scenes.csv: an independent integration through the same air (tests/oracle/targets.py)
// tolerance: 0.005 degree is promised for folds; where rays begin a pixel of at most 4.8", 0.0014 degree. Heights:
// at a fold
//            they hardly change within a pixel (1 %), where rays begin by the slope of a pixel (1 % and 0.7 m)
TEST(MirageScenes, FoldsHiddenHeightsAndNumbersOfImages) {
  const ReferenceTable table("mirage_scenes.csv");
  std::string name;
  Column column;
  int rows = 0;
  for (const ReferenceRow &row : table.rows()) {
    if (row.text("scene") != name) column = Column::of(name = row.text("scene"));
    SCOPED_TRACE(name + " " + row.text("what"));
    const double deg = row.number("altitude_deg"), known_m = row.number("height_m");
    double height = 0;
    ++rows;
    if (row.text("what") == "begins") {
      EXPECT_NEAR(column.begins_deg(height), deg, 0.0014);
      EXPECT_NEAR(height, known_m, 0.01 * known_m + 0.7);
    } else if (row.text("what") == "highest" || row.text("what") == "lowest") {
      EXPECT_NEAR(column.fold_deg(deg, row.text("what") == "highest" ? 1 : -1, height), deg, 0.005);
      EXPECT_NEAR(height, known_m, 0.01 * known_m);
    } else {
      EXPECT_EQ(column.images_of(known_m), static_cast<int>(deg));
    }
  }
  EXPECT_EQ(rows, 19);
}

}  // namespace greenray
