// The figures of the gallery's mirages and mountains: hidden heights and numbers of images, as `greenray trace SCENE`
// tells them.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "render/solver_choice.hpp"
#include "render/sun_place.hpp"
#include "render/targets_in_view.hpp"
#include "scene/scene_file.hpp"
#include "support_code/reference_table.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

using testing_data::ReferenceRow;
using testing_data::ReferenceTable;

/// What an oracle says of a scene: the lowest height that is seen at a distance, and how often another one is.
struct Known {
  double distance_m = 0, hidden_m = 1e9, counted_m = 0;
  std::size_t images = 0;
};

std::map<std::string, Known> known_of(const char *file) {
  std::map<std::string, Known> all;
  const ReferenceTable table(file);
  for (const ReferenceRow &row : table.rows()) {
    Known &known = all[row.text("scene")];
    known.distance_m = row.number("distance_m");
    const std::string what = row.text("what");
    if (what == "begins" || what == "lowest") known.hidden_m = std::min(known.hidden_m, row.number("height_m"));
    else if (what.rfind("images", 0) == 0)
      known.counted_m = row.number("height_m"), known.images = static_cast<std::size_t>(row.number("altitude_deg"));
  }
  return all;
}

/// As `greenray trace SCENE --target-distance D --target-height H`.
ViewDiagnosis view_of(const Scene &scene, const Known &known) {
  const AirSection air(spec_for(scene, {}));
  ViewRequest request;
  request.height_m = scene.observer.height_m;
  request.target = Target{known.distance_m, known.counted_m};
  request.scene_targets = targets_in_view(scene);
  return diagnose_view(air, request, shared_device());
}

void compare(const std::string &name, const Known &known) {
  SCOPED_TRACE(name);
  const std::size_t blank = name.find(' ');
  std::vector<std::string> keys;
  if (blank != std::string::npos) keys.push_back("atmosphere.profile=" + name.substr(blank + 1));
  const Scene scene = load_scene(name.substr(0, blank), keys);
  const ViewDiagnosis view = view_of(scene, known);
  ASSERT_TRUE(view.sight);
  EXPECT_NEAR(view.sight->hidden_m, known.hidden_m, 2e-3 + 1e-5 * known.hidden_m);
  EXPECT_EQ(view.sight->top.size(), known.images);
  ASSERT_EQ(view.scene_sights.size(), scene.targets.size() + (scene.terrain.field ? 1 : 0));
  std::size_t there = 0;  // the scene's own at that distance: hidden as much
  for (const auto &[target, sight] : view.scene_sights) {
    if (std::abs(sight.distance_m - known.distance_m) > 100) continue;
    ++there;
    EXPECT_NEAR(sight.hidden_m, known.hidden_m, 0.03 + 2e-3 * known.hidden_m) << target;
  }
  EXPECT_GT(there, 0u);
}

}  // namespace

// oracle: reference/mirage_scenes.csv and mountain_sights.csv (tests/oracle/targets.py: independent ODE, folds by
// golden section, the lowest ray by halving)
// tolerance: the tables' own last digit, 0.5 mm, and twice 1e-7 degree of the lowest ray at 250 km (1 mm); the lines of
// sight themselves are good to 0.01 mm. Highest terrain stands within 100 m of the summit (the look along columns):
// there 2e-3 of the hidden height, by d(hidden)/d(distance) = 0.02
TEST(GalleryMirages, HiddenHeightsAndNumbersOfImages) {
  for (const char *file : {"mirage_scenes.csv", "mountain_sights.csv"}) {
    const auto all = known_of(file);
    EXPECT_FALSE(all.empty());
    for (const auto &[name, known] : all) compare(name, known);
  }
}

// oracle: tops by the scenes' own keys: superior-mirage's hull, bridge and mast stand 16, 30 and 38 m high (its
// comment); the summit of canigou, 2784 m at 250430 m (chord of the ellipsoid and its sagitta)
// tolerance: a step of the look along azimuths, 100 m, and the slope of the grid's cells over it
TEST(GalleryMirages, TargetsOfAScene) {
  const std::vector<SceneTarget> ship = targets_in_view(load_scene("superior-mirage"));
  double highest = 0;
  for (const SceneTarget &part : ship) highest = std::max(highest, part.target.height_m);
  EXPECT_EQ(ship.front().name, "target 1, polygon");
  EXPECT_DOUBLE_EQ(ship.front().target.height_m, 16);
  EXPECT_DOUBLE_EQ(highest, 38);
  const std::vector<SceneTarget> mountain = targets_in_view(load_scene("canigou"));
  ASSERT_EQ(mountain.size(), 1u);
  EXPECT_EQ(mountain[0].name, "highest terrain");
  EXPECT_NEAR(mountain[0].target.distance_m, 250430, 150);
  EXPECT_NEAR(mountain[0].target.height_m, 2784, 30);
}

}  // namespace greenray
