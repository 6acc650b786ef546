// Terrain from the command line: a picture with its channels and errors, and one clear complaint for each wrong input.
#include <nlohmann/json.hpp>

#include "cli/tool.hpp"
#include "image/exr.hpp"

namespace greenray::cli_tests {
namespace {

/// A grid of 0.01 degree about 46.2 N 7.2 E, 41 x 41 nodes of which one may be void.
std::string grid(double height_m, int void_row = -1) {
  std::string text = "ncols 41\nnrows 41\nxllcenter 7.0\nyllcenter 46.0\ncellsize 0.01\nNODATA_value -9999\n";
  for (int row = 0; row < 41; ++row)
    for (int column = 0; column < 41; ++column)
      text += (row == void_row && column == 20 ? "-9999" : std::to_string(height_m * (40 - row) / 40)) + " ";
  return text;
}

class TerrainTool : public ToolTest {
 protected:
  void scene(double height_m, double farthest_m, const std::string &more = "") const {
    write(folder / "hills.toml",
          "greenray = 1\n[observer]\nplace = { latitude_deg = 46.02, longitude_deg = 7.2 }\nheight_m = " +
              std::to_string(height_m) +
              "\nazimuth_deg = 0.0\naltitude_deg = 3.0\nfov_deg = 12.0\nresolution = [16, 12]\n[sun]\n"
              "altitude_deg = 40.0\nazimuth_deg = 180.0\n[spectrum]\nsamples = 2\n[tracing]\nquality = { spp = 4 }\n"
              "[terrain]\ntiles = [\"hills.asc\"]\nfarthest_m = " +
              std::to_string(farthest_m) + "\n" + more);
  }
  /// Exit code 2 and one line that says so; nothing beside what was there.
  void expect_refused(const Words &words, const std::string &says) const {
    const auto before = listing(folder);
    const Outcome o = run(words);
    EXPECT_EQ(o.code, 2) << o.err;
    EXPECT_NE(o.err.find(says), std::string::npos) << o.err;
    EXPECT_EQ(lines_of(o.err).size(), 1u) << o.err;
    EXPECT_EQ(listing(folder), before);
  }
};

// oracle: the ground is a plane that rises 2000 m over 0.4 degree (111.15 km a degree there) northward, so that a ray
// of elevation e from 200 m above it, straight and over a flat Earth, meets it at 200 m/(0.0450 - tan e) tolerance: 3
// %: the Earth's curve lowers the ground by d^2/2R, 8 m at 10 km, and air bends by an eighth of that
TEST_F(TerrainTool, APictureOfASlope) {
  write(folder / "hills.asc", grid(2000));
  scene(100 + 200, 40e3);
  const Outcome o = run({"render", "hills.toml", "-o", "hills.exr", "--report", "off"});
  ASSERT_EQ(o.code, 0) << o.err;
  const auto report = nlohmann::json::parse(contents(folder / "hills.json"));
  EXPECT_GT(report["error"]["terrain_arcsec"].get<double>(), 0);
  EXPECT_LT(report["error"]["terrain_arcsec"].get<double>(), 0.05 * 12 * 3600 / 16);
  EXPECT_LT(report["error"]["ground_arcsec"].get<double>(), 1);  // a plane
  const SpectralImage image = read_exr(folder / "hills.exr").spectral();
  const auto &distance = image.channels.at("target_distance_m");
  const double pixel = 2 * std::tan(6 * 3.14159265 / 180) / 16;
  int met = 0;
  for (int row = 0; row < 12; ++row) {
    const double tangent = std::tan(3 * 3.14159265 / 180 + std::atan((6 - row - 0.5) * pixel)),
                 slope = 2000 / (0.4 * 111150);
    const double seen = static_cast<double>(distance[static_cast<std::size_t>(16 * row + 8)]);
    if (tangent < slope - 0.02) {
      EXPECT_NEAR(seen, 200 / (slope - tangent), 0.03 * 200 / (slope - tangent)) << row;
      ++met;
    } else if (tangent > slope + 0.02) {
      EXPECT_EQ(seen, 0) << row;
    }
  }
  EXPECT_GT(met, 2);
}

TEST_F(TerrainTool, MissingTilesVoidsAndBuriedEyesAreRefused) {
  write(folder / "hills.asc", grid(2000));
  scene(300, 60e3);
  const std::string missing = "found none of N46E007; or missing = \"sea\", or a nearer farthest_m";
  expect_refused({"render", "hills.toml", "-o", "a.exr"}, missing);
  expect_refused({"check", "hills.toml"}, missing);
  scene(300, 60e3, "missing = \"sea\"");
  EXPECT_EQ(run({"check", "hills.toml"}).code, 0);
  scene(20, 40e3);
  expect_refused({"render", "hills.toml", "-o", "a.exr"},
                 "hills.toml:4:12: 'observer.height_m': the eye would stand below");
  write(folder / "hills.asc", grid(2000, 20));
  scene(300, 40e3);
  expect_refused({"render", "hills.toml", "-o", "a.exr", "--quiet"}, "found void ones, the nearest");
  scene(300, 18e3);
  EXPECT_EQ(run({"render", "hills.toml", "-o", "b.exr", "--report", "off"}).code, 0);
  write(folder / "hills.asc", grid(2000).substr(0, 5000));
  expect_refused({"render", "hills.toml", "-o", "a.exr"}, "cut short?");
}

}  // namespace
}  // namespace greenray::cli_tests
