// Commands that make and look at pictures, as a user runs them.
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "cli/tool.hpp"
#include "image/exr.hpp"

namespace greenray::cli_tests {

using Json = nlohmann::json;

class Pictures : public ToolTest {
 protected:
  void SetUp() override {
    ToolTest::SetUp();
    write(folder / "s.toml", small_scene);
  }
  /// Renders the small scene to NAME.exr with more flags; the picture must be there.
  ExrPicture render(const std::string &name, const Words &more = {}, const std::string &scene = "s.toml") const {
    Words words{"render", scene, "-q", "-o", name + ".exr"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome result = run(words);
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(result.out, "") << "--quiet";
    return read_exr(folder / (name + ".exr"));
  }
  Json report(const std::string &name) const { return Json::parse(contents(folder / (name + ".json"))); }
};

namespace {

/// All channels of all parts are the same bits.
bool same_pixels(const ExrPicture &a, const ExrPicture &b) {
  if (a.parts.size() != b.parts.size()) return false;
  for (std::size_t i = 0; i < a.parts.size(); ++i)
    if (a.parts[i].channels != b.parts[i].channels) return false;
  return true;
}

/// Height over width of what is brighter than half of the brightest pixel, in pixels.
double height_over_width(const ExrPicture &picture) {
  const ExrPart &part = picture.parts.at(0);
  const std::vector<float> &light = part.channels.at("G");
  const float half = 0.5F * *std::max_element(light.begin(), light.end());
  std::vector<int> by_row(static_cast<std::size_t>(part.height)), by_column(static_cast<std::size_t>(part.width));
  for (std::size_t i = 0; i < light.size(); ++i)
    if (light[i] > half) ++by_row[i / by_column.size()], ++by_column[i % by_column.size()];
  return static_cast<double>(*std::max_element(by_column.begin(), by_column.end())) /
         static_cast<double>(*std::max_element(by_row.begin(), by_row.end()));
}

}  // namespace

// oracle: promise of the user's page: same seed, same device, same version: the same bits.  tolerance: none
TEST_F(Pictures, SameSeedSameBits) {
  const ExrPicture first = render("a", {"--seed", "7"}, "smoke"), second = render("b", {"--seed", "7"}, "smoke"),
                   other = render("c", {"--seed", "8"}, "smoke");
  EXPECT_TRUE(same_pixels(first, second));
  EXPECT_EQ(contents(folder / "a.png"), contents(folder / "b.png"));
  EXPECT_FALSE(same_pixels(first, other));
  const auto rgb = [&](const ExrPicture &p) { return p.parts.at(0).channels.at("G"); };
  EXPECT_NE(rgb(first), rgb(other));
}

// oracle: the picture itself: a crop is a part of it.  tolerance: none, bit for bit
TEST_F(Pictures, CropIsAPartOfThePicture) {
  const ExrPicture whole = render("whole", {"--size", "67x48", "--spp", "9"}),
                   part = render("part", {"--size", "67x48", "--spp", "9", "--crop", "21,9,50,42"});
  ASSERT_EQ(part.parts.at(0).width, 29);
  ASSERT_EQ(part.parts.at(0).height, 33);
  ASSERT_EQ(part.parts.size(), whole.parts.size());
  for (std::size_t p = 0; p < whole.parts.size(); ++p)
    for (const auto &[name, values] : whole.parts[p].channels) {
      const std::vector<float> &cropped = part.parts[p].channels.at(name);
      std::size_t different = 0;
      for (std::size_t y = 0; y < 33; ++y)
        for (std::size_t x = 0; x < 29; ++x) different += cropped[y * 29 + x] != values[(y + 9) * 67 + x + 21];
      EXPECT_EQ(different, 0U) << name;
    }
}

// oracle: a disk without refraction is a circle; refraction flattens it (0.83 at this height).
// tolerance: one pixel of the disk's 64 on each side
TEST_F(Pictures, StraightSunIsRound) {
  const Words close{"--size", "96x96", "-D", "sun.limb_darkening=false", "-D", "observer.altitude_deg=0.3"};
  Words straight = close;
  straight.insert(straight.end(), {"--straight", "-D", "sun.altitude_deg=0.3"});
  EXPECT_NEAR(height_over_width(render("straight", straight)), 1.0, 2.0 / 64);
  Words bent = close;
  bent.insert(bent.end(), {"-D", "sun.apparent_altitude_deg=0.3"});
  EXPECT_LT(height_over_width(render("bent", bent)), 0.90);
  EXPECT_TRUE(report("straight").at("straight").get<bool>());
  const Json left = report("straight").at("plan").at("left_out");
  EXPECT_EQ(std::count(left.begin(), left.end(), "bending: --straight"), 1);
}

// oracle: the values given.  tolerance: none
TEST_F(Pictures, OverridesAndSizesCount) {
  const ExrPicture picture =
      render("x", {"-D", "spectrum.samples=3", "-D", "observer.resolution=[20, 10]", "-D", "tracing.quality.spp=5"});
  EXPECT_EQ(picture.parts.at(0).width, 20);
  EXPECT_EQ(picture.spectral().wavelength_nm.size(), 3U);
  EXPECT_EQ(report("x").at("samples_per_pixel"), 5);
  EXPECT_NE(std::get<std::string>(picture.attributes.at("greenray.overrides")).find("spectrum.samples=3"),
            std::string::npos);
  EXPECT_EQ(render("y", {"--quick", "--size", "40x20"}).parts.at(0).width, 10);
}

// oracle: the contract's list of keys and channels; outcomes are counted on the device, rays by the plan.  tolerance:
// none
TEST_F(Pictures, ReportAndChannelsAsTheContract) {
  const ExrPicture picture = render("deep/er/x", {"--seed", "5"});
  const Json json = report("deep/er/x");
  for (const char *key : {"scene_hash", "version", "seed", "device", "plan", "outcomes", "photons", "error", "seconds"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json.at("seed"), 5);
  const std::map<std::string, std::vector<std::string>> inner{
      {"plan", {"modelled", "left_out"}},
      {"photons", {"emitted", "stored_diffuse", "stored_caustic"}},
      {"error", {"table_arcsec", "solver_arcsec", "noise_rms", "bias"}},
      {"seconds", {"compile", "build", "emit", "map", "gather", "eye", "total"}}};
  for (const auto &[object, keys] : inner)
    for (const std::string &key : keys) EXPECT_TRUE(json.at(object).contains(key)) << object << "." << key;
  long long sum = 0;
  for (const auto &[name, count] : json.at("outcomes").items()) sum += count.get<long long>();
  EXPECT_EQ(sum, json.at("rays_launched").get<long long>());
  EXPECT_GT(json.at("table").at("transfer_entries").get<long long>(), 2);
  EXPECT_GT(json.at("outcomes").at("space").get<long long>(), 0);
  EXPECT_GT(json.at("outcomes").at("ground").get<long long>(), 0);

  const ExrPart &part = picture.parts.at(0);
  for (const char *name : {"R", "G", "B", "S0.390,000000nm", "S0.720,000000nm"})
    EXPECT_EQ(part.channels.count(name), 1U) << name;
  EXPECT_EQ(part.channels.size(), 5U);
  EXPECT_EQ(std::get<std::string>(picture.attributes.at("greenray.scene")), small_scene);
  EXPECT_EQ(std::get<std::string>(picture.attributes.at("greenray.seed")), "5");
  EXPECT_EQ(std::get<std::string>(picture.attributes.at("greenray.scene_hash")), json.at("scene_hash"));
  EXPECT_EQ(listing(folder / "deep/er").size(), 4U) << "only x.exr, x.png, x.json, x.html";
}

// oracle: every line of --json parses; fractions rise.  tolerance: none
TEST_F(Pictures, ProgressAsJsonLines) {
  const Outcome result = run({"render", "s.toml", "--json", "-o", "x.exr", "--spp", "64"});
  ASSERT_EQ(result.code, 0) << result.err;
  const auto lines = lines_of(result.out);
  double before = 0;
  for (const std::string &line : lines) {
    const Json json = Json::parse(line);
    if (json.at("event") != "progress" || json.at("phase") != "picture") continue;
    EXPECT_GE(json.at("fraction").get<double>(), before);
    before = json.at("fraction");
  }
  EXPECT_EQ(before, 1.0);
  EXPECT_EQ(Json::parse(lines.back()).at("report").at("scene_hash"), report("x").at("scene_hash"));
}

// oracle: while a picture is made over an old one, the file holds the old bytes or the new ones, and nothing else.
// tolerance: none
TEST_F(Pictures, AppearsAsAWhole) {
  write(folder / "x.exr", "old");
  How how = here();
  std::vector<std::string> seen;
  how.meanwhile = [&](pid_t child) {
    siginfo_t ended{};
    while (::waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 && ended.si_pid == 0) {
      const std::string now = contents(folder / "x.exr");
      if (seen.empty() || seen.back() != now) seen.push_back(now);
    }
  };
  ASSERT_EQ(run_tool({"render", "s.toml", "-q", "-o", "x.exr", "--size", "320x240"}, how).code, 0);
  const std::string last = contents(folder / "x.exr");
  for (const std::string &bytes : seen) EXPECT_TRUE(bytes == "old" || bytes == last) << bytes.size() << " bytes";
}

// oracle: the contract: keys of --json, exit 6 above --max-rms; a picture equals itself.  tolerance: none
TEST_F(Pictures, Compare) {
  render("a");
  render("b", {"--seed", "2"});
  const Outcome same = run({"compare", "a.exr", "a.exr", "--max-rms", "0", "--json"});
  EXPECT_EQ(same.code, 0) << same.err;
  const Json json = Json::parse(same.out);
  EXPECT_EQ(json.at("rms"), 0.0);
  EXPECT_EQ(json.at("max_abs"), 0.0);
  EXPECT_EQ(json.at("relative_rms"), 0.0);
  EXPECT_TRUE(json.at("psnr_db").is_null()) << "infinite";
  EXPECT_EQ(json.at("pixels"), 16 * 12);
  const Outcome differ = run({"compare", "a.exr", "b.exr", "--json"});
  EXPECT_EQ(differ.code, 0);
  const double rms = Json::parse(differ.out).at("rms");
  EXPECT_GT(rms, 0);
  EXPECT_EQ(run({"compare", "a.exr", "b.exr", "--max-rms", std::to_string(rms * 0.99)}).code, 6);
  EXPECT_EQ(run({"compare", "a.exr", "b.exr", "--max-rms", std::to_string(rms * 1.01)}).code, 0);
}

// oracle: the PNG that `render` wrote from the same radiance; two stops more light make another picture.  tolerance:
// none
TEST_F(Pictures, DevelopAgain) {
  render("a");
  EXPECT_EQ(run({"develop", "a.exr", "-o", "new/b.png"}).code, 0);
  EXPECT_EQ(contents(folder / "new/b.png"), contents(folder / "a.png"));
  EXPECT_EQ(run({"develop", "a.exr", "-o", "c.png", "--exposure", "2"}).code, 0);
  EXPECT_NE(contents(folder / "c.png"), contents(folder / "a.png"));
}

// oracle: the way the user's page describes.  tolerance: none
TEST_F(Pictures, NewCheckRender) {
  EXPECT_EQ(run({"new", "my/sunset.toml"}).code, 0);
  const Outcome check = run({"check", "my/sunset.toml"});
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_NE(check.out.find("modelled bent rays"), std::string::npos) << check.out;
  const Json json = Json::parse(run({"check", "my/sunset.toml", "--json"}).out);
  EXPECT_FALSE(json.at("plan").at("modelled").empty());
  const Outcome made = run({"render", "my/sunset.toml", "--quick", "--spp", "2"});
  EXPECT_EQ(made.code, 0) << made.err;
  for (const char *name : {"out/sunset.exr", "out/sunset.png", "out/sunset.json"})
    EXPECT_TRUE(fs::exists(folder / name));
  EXPECT_NE(made.out.find("wrote    out/sunset.exr"), std::string::npos) << made.out;
}

// oracle: what ships must pass its own check.  tolerance: none
TEST_F(Pictures, ScenesThatShip) {
  const Json scenes = Json::parse(run({"scenes", "--json"}).out);
  EXPECT_GE(scenes.size(), 4U);
  const std::string text = run({"scenes"}).out;
  for (const Json &scene : scenes) {
    const std::string name = scene.at("name");
    EXPECT_NE(text.find(name + "  "), std::string::npos);
    EXPECT_EQ(run({"check", name}).code, 0) << name;
  }
}

}  // namespace greenray::cli_tests
