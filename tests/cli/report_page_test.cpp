// OUT.html beside a picture: whole, well formed, of this file alone, with numbers that the JSON has too.
#include <nlohmann/json.hpp>

#include "cli/tool.hpp"
#include "support_code/markup.hpp"

namespace greenray::cli_tests {
namespace {

using Json = nlohmann::json;
class ReportPage : public ToolTest {};

// oracle: the user's page: one file, no network, no script; well-formed markup.  tolerance: none
TEST_F(ReportPage, stands_alone_beside_a_sky_picture) {
  write(folder / "s.toml", small_scene);
  ASSERT_EQ(run({"render", "s.toml", "-q", "-o", "x.exr"}).code, 0);
  const std::string page = contents(folder / "x.html");
  EXPECT_EQ(complaint(page), "");
  for (const char *outside : {"<script", "src=\"http", "href=", "@import", "url(http"})
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
  for (const char *section : {"1  The picture", "2  The air", "3  Rays", "4  Colour", "5  Trust", "6  Speed"})
    EXPECT_NE(page.find(section), std::string::npos) << section;
  const Json json = Json::parse(contents(folder / "x.json"));
  for (const char *key : {"view", "refraction", "rim", "trust", "command", "speed"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_NE(page.find(json.at("command").get<std::string>()), std::string::npos);
  EXPECT_EQ(json.at("view").at("transfer").at(0).at("most_images"), 1) << "standard air shows every point once";
}

// oracle: Oriani's theorem (1788) for refraction at 45 degrees, whatever the layers; halved steps change next to
// nothing tolerance: its next term, 3 (n-1) (8.4 km/R)^2 tan^5 z = 0.0003"; order 5 at 1e-9 rad a step: 1e-3"
TEST_F(ReportPage, trust_figures_are_small) {
  write(folder / "s.toml", small_scene);
  ASSERT_EQ(run({"render", "s.toml", "-q", "-o", "x.exr"}).code, 0);
  const Json trust = Json::parse(contents(folder / "x.json")).at("trust");
  EXPECT_NEAR(trust.at("oriani_45_arcsec").get<double>(), trust.at("ours_45_arcsec").get<double>(), 2e-3);
  EXPECT_LT(trust.at("step_halving_arcsec").get<double>(), 1e-2);
}

// oracle: the flag's words: off leaves it out; a wrong word is told before anything is made.  tolerance: none
TEST_F(ReportPage, is_left_out_when_not_wanted) {
  write(folder / "s.toml", small_scene);
  ASSERT_EQ(run({"render", "s.toml", "-q", "-o", "x.exr", "--report", "off"}).code, 0);
  EXPECT_FALSE(fs::exists(folder / "x.html"));
  EXPECT_EQ(run({"render", "s.toml", "-q", "-o", "y.exr", "--report", "maybe"}).code, 2);
  EXPECT_FALSE(fs::exists(folder / "y.exr"));
}

// oracle: the numbers that were given: the same view by `trace`, from the scene and from its profile.  tolerance: none
TEST_F(ReportPage, trace_tells_the_same_view) {
  write(folder / "s.toml", small_scene);
  const Outcome scene = run({"trace", "s.toml", "--json", "--plot", "v.svg"}),
                profile = run({"trace", "us76", "--height", "2", "--json", "--target-distance", "20km",
                               "--target-height", "100ft"});
  ASSERT_EQ(scene.code, 0) << scene.err;
  ASSERT_EQ(profile.code, 0) << profile.err;
  EXPECT_EQ(complaint(contents(folder / "v.svg")), "");
  const Json a = Json::parse(scene.out), b = Json::parse(profile.out);
  EXPECT_EQ(a.at("transfer"), b.at("transfer"));
  EXPECT_EQ(b.at("target").at("target_height_m"), 30.48);
  EXPECT_EQ(run({"trace", "us76", "--height", "2", "--target-distance", "20 parsec", "--target-height", "1"}).code, 2);
  EXPECT_EQ(run({"trace", "us76"}).code, 2) << "a profile has no eye";
}

}  // namespace
}  // namespace greenray::cli_tests
