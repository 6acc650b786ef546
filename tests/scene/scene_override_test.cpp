// Scenes changed by -D KEY=VALUE, and the hash that tells pictures apart.
#include <gtest/gtest.h>

#include "scene/room_scene.hpp"
#include "scene/scene_file.hpp"

namespace greenray {
namespace {

std::vector<Diagnostic> complaints(const std::string &text, const std::vector<std::string> &overrides = {}) {
  try {
    parse_scene("my.toml", text, overrides);
  } catch (const InputError &error) {
    return error.diagnostics();
  }
  return {};
}

const char *const small = "greenray = 1\n[observer]\nheight_m = 5\n[sun]\naltitude_deg = -0.5\n";

// oracle: the values given
// tolerance: none
TEST(SceneOverride, OverridesReplaceOneValue) {
  const Scene scene =
      parse_scene("my.toml", small,
                  {"sun.altitude_deg=-0.25", "sky.model=academic", "output.image = out/a-1.exr",
                   "atmosphere.aerosol.visibility_km=20", "observer.resolution=[64, 48]", "title=é \"b\\c",
                   "spectrum.samples=12.0", "observer.height_m=7", "observer.height_m=8"});
  EXPECT_EQ(scene.sun.altitude_deg, -0.25);
  EXPECT_EQ(scene.sky.model, SkyScene::Model::academic);
  EXPECT_EQ(scene.output.image, "out/a-1.exr");
  EXPECT_EQ(scene.atmosphere.visibility_km, 20.0);
  EXPECT_EQ(scene.observer.resolution, (std::array<int, 2>{64, 48}));
  EXPECT_EQ(scene.title, "é \"b\\c");
  EXPECT_EQ(scene.spectrum.samples, 12);
  EXPECT_EQ(scene.observer.height_m, 8.0);
  EXPECT_EQ(scene.overrides.size(), 9u);
}

// oracle: one altitude at a time; the command line has the last word
// tolerance: none
TEST(SceneOverride, OverrideOfOneAltitudeDropsTheOther) {
  const Scene scene = parse_scene("my.toml", small, {"sun.apparent_altitude_deg=0.3"});
  EXPECT_EQ(scene.sun.given, SunScene::Given::apparent_altitude);
  EXPECT_EQ(scene.sun.altitude_deg, 0.3);
  EXPECT_EQ(complaints(small, {"sun.apparent_altitude_deg=0.3", "sun.altitude_deg=0"}).size(), 1u);
}

constexpr const char *room = R"(greenray = 1
[camera]
from = [0.5, -1.0, 0.5]
to = [0.5, 0.0, 0.5]
[[quad]]
corner = [0.0, 0.0, 0.0]
edge_u = [1.0, 0.0, 0.0]
edge_v = [0.0, 1.0, 0.0]
reflectance = 0.5
[[light]]
kind = "point"
from = [0.5, 0.5, 1.0]
power_W = 10.0
[[light]]
kind = "point"
from = [0.5, 0.2, 1.0]
power_W = 20.0
)";

// oracle: the text itself
// tolerance: none
TEST(SceneOverride, RowsAreReachedByNumber) {
  const RoomScene scene = parse_room("room.toml", room, {"light.1.power_W=0.5"});
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[0].power_W, 10);
  EXPECT_EQ(scene.lights[1].power_W, 0.5);
  for (const char *wrong :
       {"light.2.power_W=1", "light.-1.power_W=1", "light.x.power_W=1", "light.0=1", "light.0.powr_W=1"})
    EXPECT_THROW(parse_room("room.toml", room, {wrong}), InputError) << wrong;
}

struct WrongOverride {
  const char *assignment;
  int column;
  const char *says;
};

// oracle: columns counted by hand
// tolerance: none
TEST(SceneOverride, ComplaintsAboutOverridesPointAtThem) {
  const std::vector<WrongOverride> table{
      {"observer.height_m=-3", 19, "from 0 to 1e+07 m, found -3"},
      {"observer.height_m = tall", 21, "found text"},
      {"observer.heigth_m=3", 10, "did you mean 'height_m'?"},
      {"obsever.height_m=3", 1, "did you mean 'observer'?"},
      {"observer.height_m", 1, "expected KEY=VALUE"},
      {"=3", 1, "expected KEY=VALUE"},
      {"[observer]=3", 1, "expected KEY=VALUE"},
      {"observer.height_m=3\ntitle=4", 1, "expected KEY=VALUE"},
      {"observer.resolution=[1,", 24, "not valid TOML"},
      {"observer..height_m=3", 10, "not valid TOML"},
  };
  for (const WrongOverride &wrong : table) {
    SCOPED_TRACE(wrong.assignment);
    const auto all = complaints(small, {wrong.assignment});
    EXPECT_EQ(all.size(), 1u) << (all.empty() ? "" : InputError(all).what());
    if (all.empty()) continue;
    EXPECT_EQ(all[0].place.file, "-D " + std::string(wrong.assignment));
    EXPECT_EQ(all[0].place.line, 1);
    EXPECT_EQ(all[0].place.column, wrong.column) << all[0].text();
    EXPECT_NE(all[0].message.find(wrong.says), std::string::npos) << all[0].text();
  }
}

// oracle: what does and does not change a picture
// tolerance: none
TEST(SceneHash, FollowsThePictureOnly) {
  const std::string hash = scene_hash(parse_scene("my.toml", small));
  EXPECT_EQ(hash.size(), 16u);
  EXPECT_EQ(hash, scene_hash(parse_scene("other.toml", std::string("# comment\n") + small)));
  EXPECT_EQ(hash, scene_hash(parse_scene("my.toml", small, {"output.image=b.exr"})));
  EXPECT_EQ(hash, scene_hash(parse_scene("my.toml", small, {"title=b", "observer.height_m=5.0"})));
  std::vector<std::string> hashes{hash};
  for (const char *change : {"sun.altitude_deg=-0.51",
                             "sun.apparent_altitude_deg=-0.5",
                             "observer.height_m=5.000001",
                             "observer.azimuth_deg=1",
                             "observer.resolution=[300, 400]",
                             "atmosphere.profile=hot-road",
                             "atmosphere.profile=cold-sea",
                             "atmosphere.dispersion=ciddor",
                             "atmosphere.exaggerate=2",
                             "atmosphere.humidity=false",
                             "atmosphere.aerosol.visibility_km=9",
                             "atmosphere.aerosol.turbidity=9",
                             "sky.model=academic",
                             "spectrum.samples=8",
                             "tracing.quality.spp=4",
                             "tracing.precision=double",
                             "eye.model=human",
                             "eye.exposure_ev=0",
                             "eye.bleaching.seconds=0",
                             "output.spectral=false"}) {
    hashes.push_back(scene_hash(parse_scene("my.toml", small, {change})));
    for (std::size_t i = 0; i + 1 < hashes.size(); ++i) EXPECT_NE(hashes[i], hashes.back()) << change;
  }
}

}  // namespace
}  // namespace greenray
