// [[target]] rows of scene files: defaults, what is read, and what is said about wrong ones.
#include <gtest/gtest.h>

#include "scene/scene_file.hpp"

namespace greenray {
namespace {

struct Wrong {
  const char *text;
  int line, column;
  const char *says;
};

const std::vector<Wrong> wrong_targets{
    {"[[target]]\nkind = \"cube\"\ndistance_m = 5.0\nwidth_m = 1\nheight_m = 1\nreflectance = 0.1", 3, 8,
     "one of billboard, rectangle, triangle, polygon"},
    {"[[target]]\ndistance_m = 5.0\nwidth_m = 1\nheight_m = 1\nreflectance = 0.1", 2, 1, "missing key 'target.kind'"},
    {"[[target]]\nkind = \"rectangle\"\nwidth_m = 1\nheight_m = 1\nreflectance = 0.1", 2, 1,
     "missing key 'target.distance_m'"},
    {"[[target]]\nkind = \"rectangle\"\ndistance_m = 0.0\nwidth_m = 1\nheight_m = 1\nreflectance = 0.1", 4, 14,
     "from 1 to 1e+06 m, found 0"},
    {"[[target]]\nkind = \"triangle\"\ndistance_m = 5.0\nheight_m = 1\nreflectance = 0.1", 2, 1,
     "missing key 'target.width_m'"},
    {"[[target]]\nkind = \"triangle\"\ndistance_m = 5.0\nwidth_m = 0\nheight_m = 1\nreflectance = 0.1", 5, 11,
     "above 0 and at most 1e+06 m"},
    {"[[target]]\nkind = \"triangle\"\ndistance_m = 5.0\nwidth_m = 1\nheight_m = 1", 2, 1,
     "missing key 'target.reflectance'"},
    {"[[target]]\nkind = \"triangle\"\ndistance_m = 5.0\nwidth_m = 1\nheight_m = 1\nreflectance = 1.5", 7, 15,
     "from 0 to 1"},
    {"[[target]]\nkind = \"triangle\"\ndistance_m = 5.0\nwidth_m = 1\nheight_m = 1\nreflectance = [0.1, 0.2]", 7, 15,
     "[r, g, b]"},
    {"[[target]]\nkind = \"triangle\"\ndistance_m = 5.0\nwidth_m = 1\nheight_m = 1\nreflectance = 0.1\n"
     "luminance_cd_m2 = 3.0",
     7, 15, "found both"},
    {"[[target]]\nkind = \"triangle\"\ndistance_m = 5.0\nwidth_m = 1\nheight_m = 1\nreflectance = 0.1\ncolour = 0.5", 8,
     10, "luminance_cd_m2 beside it"},
    {"[[target]]\nkind = \"rectangle\"\ndistance_m = 5.0\nwidth_m = 1\nheigth_m = 1\nheight_m = 1\nreflectance = 0.1",
     6, 1, "did you mean 'height_m'?"},
    {"[[target]]\nkind = \"rectangle\"\ndistance_m = 5.0\nwidth_m = 1\nheight_m = 1\nreflectance = 0.1\n"
     "outline_m = [[0, 0], [1, 0], [0, 1]]",
     8, 1, "unknown key 'target.outline_m'"},
    {"[[target]]\nkind = \"polygon\"\ndistance_m = 5.0\nreflectance = 0.1", 2, 1, "missing key 'target.outline_m'"},
    {"[[target]]\nkind = \"polygon\"\ndistance_m = 5.0\nreflectance = 0.1\noutline_m = [[0, 0], [1, 0]]", 6, 13,
     "3 to 4096 corners, found 2"},
    {"[[target]]\nkind = \"polygon\"\ndistance_m = 5.0\nreflectance = 0.1\noutline_m = [[0, 0], [1, 0], [1, 2, 3]]", 6,
     30, "pairs [x, y]"},
    {"[[target]]\nkind = \"polygon\"\ndistance_m = 5.0\nreflectance = 0.1\noutline_m = [[0, 0], [1, 0], [1, \"a\"]]", 6,
     34, "found text \"a\""},
    {"[[target]]\nkind = \"polygon\"\ndistance_m = 5.0\nreflectance = 0.1\noutline_m = 3", 6, 13, "found 3"},
    {"[[target]]\nkind = \"billboard\"\ndistance_m = 5.0\nwidth_m = 1\nheight_m = 1", 2, 1,
     "missing key 'target.picture'"},
    {"[[target]]\nkind = \"billboard\"\ndistance_m = 5.0\nwidth_m = 1\nheight_m = 1\npicture = \"ship.jpg\"", 7, 11,
     "ends in .png or .exr"},
    {"[[target]]\nkind = \"billboard\"\ndistance_m = 5.0\nwidth_m = 1\nheight_m = 1\npicture = \"none.png\"", 7, 11,
     "no such picture: 'none.png'"},
    {"[sea]\nsignificant_height_m = 1.0", 2, 1, "missing key 'sea.wind_m_s'"},
    {"[sea]\nwind_m_s = 61", 3, 12, "from 0 to 60 m/s, found 61"},
    {"[sea]\nwind_m_s = 6\nheight_m = 2", 4, 1, "unknown key 'sea.height_m'"},
    {"[target]\nkind = \"rectangle\"", 2, 1, "rows, each begun by [[target]]"},
};

}  // namespace

// oracle: line and column counted by hand in each text; ranges and words of the file format
// tolerance: none
TEST(TargetFile, SaysWhereAndWhatWasExpected) {
  for (const Wrong &wrong : wrong_targets) {
    SCOPED_TRACE(wrong.text);
    std::vector<Diagnostic> all;
    try {
      parse_scene("my.toml", "greenray = 1\n" + std::string(wrong.text));
    } catch (const InputError &error) {
      all = error.diagnostics();
    }
    EXPECT_EQ(all.size(), 1u) << (all.empty() ? "" : InputError(all).what());
    if (all.empty()) continue;
    EXPECT_EQ(all[0].place.line, wrong.line) << all[0].text();
    EXPECT_EQ(all[0].place.column, wrong.column) << all[0].text();
    EXPECT_NE(all[0].message.find(wrong.says), std::string::npos) << all[0].text();
  }
}

// oracle: the text
// tolerance: none
TEST(TargetFile, ReadsRows) {
  const std::string text = R"(greenray = 1
[[target]]
kind = "rectangle"
distance_m = 1200
azimuth_deg = 12.5
offset_m = -3.0
base_m = 0.5
width_m = 4.0
height_m = 1.5
reflectance = [0.1, 0.2, 0.3]
[[target]]
kind = "polygon"
distance_m = 9000.0
outline_m = [[0, 0], [10, 0], [5, 8.5]]
luminance_cd_m2 = 20.0
colour = 0.5
)";
  const Scene scene = parse_scene("my.toml", text);
  ASSERT_EQ(scene.targets.size(), 2u);
  const TargetScene &a = scene.targets[0], &b = scene.targets[1];
  EXPECT_EQ(a.kind, TargetScene::Kind::rectangle);
  EXPECT_EQ(a.distance_m, 1200);
  EXPECT_EQ(a.azimuth_deg, 12.5);
  EXPECT_EQ(a.offset_m, -3);
  EXPECT_EQ(a.base_m, 0.5);
  EXPECT_EQ(a.width_m, 4);
  EXPECT_EQ(a.height_m, 1.5);
  EXPECT_EQ(a.colour, (std::array<double, 3>{0.1, 0.2, 0.3}));
  EXPECT_FALSE(a.luminance_cd_m2);
  ASSERT_EQ(b.outline_m.size(), 3u);
  EXPECT_EQ(b.outline_m[2], (std::array<double, 2>{5, 8.5}));
  EXPECT_EQ(b.luminance_cd_m2, 20);
  EXPECT_EQ(b.colour, (std::array<double, 3>{0.5, 0.5, 0.5}));
  // Every key counts in the hash, and a row can be reached from the command line.
  const Scene moved = parse_scene("my.toml", text, {"target.1.distance_m=9001.0"});
  EXPECT_EQ(moved.targets[1].distance_m, 9001);
  EXPECT_NE(scene_hash(moved), scene_hash(scene));
}

}  // namespace greenray
