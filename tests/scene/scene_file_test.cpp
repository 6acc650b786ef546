// Scene files: defaults, the promised green flash, overrides, the hash, and what is said about wrong scenes.
#include "scene/scene_file.hpp"

#include "scene/room_scene.hpp"
#include "support/embedded.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "support/embedded.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;

/// A folder of its own, gone after the test.
struct TemporaryFolder {
  fs::path path = fs::temp_directory_path() / ("greenray-scene-test-" + std::to_string(getpid()));
  TemporaryFolder() { fs::create_directories(path); }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  std::string write(const std::string &name, const std::string &text) const {
    fs::create_directories((path / name).parent_path());
    std::ofstream(path / name) << text;
    return (path / name).string();
  }
};

std::vector<Diagnostic> complaints(const std::string &text) {
  try {
    parse_scene("my.toml", text);
  } catch (const InputError &error) {
    return error.diagnostics();
  }
  return {};
}

/// The sample scene of the user guide, word for word.
const char *const green_flash = R"(greenray = 1                                   # scene format version
title    = "Mock-mirage green flash over a cool sea"

[atmosphere]
profile    = "profiles/mock-mirage.toml"       # or .csv, Wyoming .txt/.html/.csv, IGRA2 .txt
surface    = "sphere"                          # sphere | flat; radius_km = 6371.0
dispersion = "ciddor"                          # how the index depends on wavelength
humidity   = true
aerosol    = { visibility_km = 60, angstrom = 1.3 }

[observer]
height_m     = 60.0                            # eye above sea level
azimuth_deg  = 290.0                           # from north through east
altitude_deg = -0.1                            # picture centre, as seen; sea horizon is near -0.23
fov_deg      = 0.8                             # horizontal
resolution   = [1200, 900]                     # 2.4 arc-seconds per pixel

[sun]
altitude_deg = -0.96                           # centre, true: without any refraction
# apparent_altitude_deg = 0.30                 # or as seen: solved through the air above
# when = 2024-06-21T20:31:05Z                  # or time and place = { latitude_deg = .., longitude_deg = .. }
limb_darkening = true

[spectrum]
range_nm = [390, 720]
samples  = 24                                  # spaced evenly in bending: finer in the blue

[tracing]
tolerance = 1e-9                               # method = "rk45"
quality   = { spp = 64 }                       # or { error_pct = 0.5 } or { minutes = 10 }

[eye]
model     = "human"                            # human | camera | none; bleaching makes yellow look green
bleaching = { seconds = 10 }

[output]
image  = "out/green-flash.exr"                 # png and report beside it

[[sweep]]                                      # used by `greenray batch`: 61 pictures of the setting sun
key = "sun.altitude_deg"
range = { from = -0.60, to = -1.20, step = -0.01 }
)";

// oracle: the values written in the sample scene and in the profile beside it
// tolerance: none; the last sweep value to 1e-12, sixty rounded sums
TEST(SceneFile, ReadsTheGreenFlashOfTheUserGuide) {
  const TemporaryFolder folder;
  folder.write("profiles/mock-mirage.toml",
               "base = \"ussa1976\"\nsmooth_m = 2.5\n[[inversion]]\nfrom_m = 30\nto_m = 50\nrise_K = 0.8\n");
  const Scene scene = load_scene(folder.write("green-flash.toml", green_flash));
  EXPECT_EQ(scene.name, "green-flash");
  EXPECT_EQ(scene.title, "Mock-mirage green flash over a cool sea");
  EXPECT_EQ(scene.text, green_flash);
  EXPECT_EQ(scene.atmosphere.profile.name, "mock-mirage");
  EXPECT_EQ(scene.atmosphere.profile.smooth_m, 2.5);  // the file beside the scene, not the shipped one
  EXPECT_EQ(scene.atmosphere.profile.index, IndexModel::ciddor);
  EXPECT_EQ(scene.atmosphere.surface, Surface::sphere);
  EXPECT_EQ(scene.atmosphere.visibility_km, 60.0);
  EXPECT_EQ(scene.atmosphere.angstrom, 1.3);
  EXPECT_FALSE(scene.atmosphere.turbidity);
  EXPECT_EQ(scene.observer.height_m, 60.0);
  EXPECT_EQ(scene.observer.azimuth_deg, 290.0);
  EXPECT_EQ(scene.observer.altitude_deg, -0.1);
  EXPECT_EQ(scene.observer.fov_deg, 0.8);
  EXPECT_EQ(scene.observer.resolution, (std::array<int, 2>{1200, 900}));
  EXPECT_EQ(scene.sun.given, SunScene::Given::true_altitude);
  EXPECT_EQ(scene.sun.altitude_deg, -0.96);
  EXPECT_EQ(scene.spectrum.range_nm, (std::array<double, 2>{390, 720}));
  EXPECT_EQ(scene.spectrum.samples, 24);
  EXPECT_EQ(scene.tracing.tolerance, 1e-9);
  EXPECT_EQ(scene.tracing.spp, 64);
  EXPECT_EQ(scene.eye.model, EyeScene::Model::human);
  EXPECT_EQ(scene.eye.bleaching_seconds, 10.0);
  EXPECT_EQ(scene.output.image, "out/green-flash.exr");
  ASSERT_EQ(scene.sweeps.size(), 1u);
  EXPECT_EQ(scene.sweeps[0].key, "sun.altitude_deg");
  ASSERT_EQ(scene.sweeps[0].values.size(), 61u);
  EXPECT_NEAR(scene.sweeps[0].values.back(), -1.2, 1e-12);
}

// oracle: the defaults stated with the Scene structs
// tolerance: none
TEST(SceneFile, LeftOutKeysTakeTheirDefaults) {
  const Scene scene = parse_scene("folder/short.toml", "greenray = 1\n");
  const Scene standard;
  EXPECT_EQ(scene.name, "short");
  EXPECT_EQ(scene.atmosphere.profile_source, "us76");
  EXPECT_EQ(scene.sun.given, SunScene::Given::nothing);
  EXPECT_EQ(scene.eye.model, standard.eye.model);
  EXPECT_EQ(scene_hash(scene), scene_hash(standard));
}

// oracle: the template says it shows the defaults; only the Sun's altitude has none
// tolerance: none
TEST(SceneFile, TemplateShowsTheDefaults) {
  const Scene scene = load_scene("template");
  EXPECT_EQ(scene_hash(scene), scene_hash(parse_scene("a.toml", "greenray = 1\n[sun]\naltitude_deg = -0.5\n")));
  std::string all_on(*embedded_file("scenes/template.toml"));  // every commented key must be right as well
  const std::size_t terrain = all_on.find("# [terrain]");      // but those that need files: terrain_file_test
  all_on.erase(terrain, all_on.find("\n\n", terrain) - terrain);
  for (std::size_t at; (at = all_on.find("\n# ")) != std::string::npos;) {
    const std::string line = all_on.substr(at + 3, all_on.find('\n', at + 1) - at - 3);
    const bool is_key = line.find(" = ") != std::string::npos || line[0] == '[';
    bool other_altitude = false;
    for (const char *key : {"apparent", "when", "place", "after_s", "ut1"})
      other_altitude = other_altitude || line.rfind(key, 0) == 0;
    all_on.replace(at, 3, is_key && !other_altitude ? "\n" : "\n#");
  }
  EXPECT_EQ(parse_scene("all.toml", all_on).sweeps.size(), 1u) << all_on;
}

// oracle: the remaining keys, each set away from its default
// tolerance: none
TEST(SceneFile, ReadsTheOtherKeys) {
  const Scene scene = parse_scene("my.toml", R"(greenray = 1
[atmosphere]
radius_km = 6400
exaggerate = 2
ozone_DU = 250
extinction = false
humidity = false
surface = "flat"
aerosol = { turbidity = 2.5, scale_height_m = 800 }
[sun]
apparent_altitude_deg = 0.3
at = "upper-limb"
azimuth_deg = 271
diameter_arcmin = 32
limb_darkening = false
[sky]
model = "academic"
sea_reflectance = 0.1
[tracing]
method = "richardson"
transfer = "per-pixel"
precision = "double"
table_arcsec = 0.01
max_steps = 5000
quality = { error_pct = 0.5, minutes = 10 }
[eye]
model = "none"
exposure_ev = -1.5
[output]
spectral = false
[[sweep]]
key = "observer.height_m"
values = [2, 5, 10]
)");
  EXPECT_EQ(scene.atmosphere.profile.earth_radius_m, 6.4e6);
  EXPECT_EQ(scene.atmosphere.profile.exaggerate, 2.0);
  EXPECT_EQ(scene.atmosphere.ozone_DU, 250.0);
  EXPECT_FALSE(scene.atmosphere.extinction);
  EXPECT_FALSE(scene.atmosphere.humidity);
  EXPECT_EQ(scene.atmosphere.surface, Surface::flat);
  EXPECT_EQ(scene.atmosphere.turbidity, 2.5);
  EXPECT_EQ(scene.atmosphere.aerosol_scale_height_m, 800.0);
  EXPECT_EQ(scene.sun.given, SunScene::Given::apparent_altitude);
  EXPECT_EQ(scene.sun.altitude_deg, 0.3);
  EXPECT_EQ(scene.sun.part, SunScene::Part::upper_limb);
  EXPECT_EQ(scene.sun.azimuth_deg, 271.0);
  EXPECT_EQ(scene.sun.diameter_arcmin, 32.0);
  EXPECT_FALSE(scene.sun.limb_darkening);
  EXPECT_EQ(scene.sky.model, SkyScene::Model::academic);
  EXPECT_EQ(scene.sky.sea_reflectance, 0.1);
  EXPECT_EQ(scene.tracing.method, TracingScene::Method::richardson);
  EXPECT_EQ(scene.tracing.transfer, TracingScene::Transfer::per_pixel);
  EXPECT_EQ(scene.tracing.precision, TracingScene::Precision::double_);
  EXPECT_EQ(scene.tracing.table_arcsec, 0.01);
  EXPECT_EQ(scene.tracing.max_steps, 5000);
  EXPECT_EQ(scene.tracing.error_pct, 0.5);
  EXPECT_EQ(scene.tracing.minutes, 10.0);
  EXPECT_EQ(scene.eye.model, EyeScene::Model::none);
  EXPECT_EQ(scene.eye.exposure_ev, -1.5);
  EXPECT_FALSE(scene.output.spectral);
  EXPECT_EQ(scene.sweeps.at(0).values, (std::vector<double>{2, 5, 10}));
}

struct Wrong {
  const char *text;  // after the line `greenray = 1`
  int line, column;
  const char *says;
};

const std::vector<Wrong> wrong_scenes{
    {"[observer]\nheigth_m = 2", 3, 1, "unknown key 'observer.heigth_m' (did you mean 'height_m'?)"},
    {"[obsever]\nheight_m = 2", 2, 2, "unknown key 'obsever' (did you mean 'observer'?)"},
    {"observer = 3", 2, 12, "expected a table"},
    {"title = 3", 2, 9, "expected text in quotes"},
    {"[observer]\nheight_m = -1", 3, 12, "from 0 to 1e+07 m, found -1"},
    {"[observer]\nheight_m = 2e7", 3, 12, "from 0 to 1e+07 m"},
    {"[observer]\nheight_m = nan", 3, 12, "found nan"},
    {"[observer]\nfov_deg = 0", 3, 11, "above 0 and below 180 deg"},
    {"[observer]\nfov_deg = 180", 3, 11, "above 0 and below 180 deg"},
    {"[observer]\naltitude_deg = \"0\"", 3, 16, "found text \"0\""},
    {"[observer]\nresolution = [0, 5]", 3, 15, "from 1 to 16384 pixels"},
    {"[observer]\nresolution = [400, 16385]", 3, 20, "from 1 to 16384 pixels"},
    {"[observer]\nresolution = [400.5, 5]", 3, 14, "two whole numbers"},
    {"[observer]\nresolution = [400]", 3, 14, "[width, height]"},
    {"[observer]\nresolution = \"400x300\"", 3, 14, "expected an array"},
    {"[sun]\nlimb_darkening = true", 2, 1, "missing key 'sun.altitude_deg'"},
    {"[sun]\naltitude_deg = 1\napparent_altitude_deg = 1", 4, 25, "found more"},
    {"[sun]\naltitude_deg = 91", 3, 16, "from -90 to 90 deg"},
    {"[sun]\nwhen = 2024-06-21T20:31:05Z", 2, 1, "missing key 'sun.place'"},
    {"[sun]\nplace = { latitude_deg = 1.0 }", 3, 9, "expected `when` beside it"},
    {"[sun]\naltitude_deg = 0\nat = \"center\"", 4, 6, "did you mean 'centre'?"},
    {"[sun]\naltitude_deg = 0\nlimb_darkening = 1", 4, 18, "true or false"},
    {"[sky]\nmodel = \"blue\"", 3, 9, "one of plain, academic"},
    {"[sky]\nsea_reflectance = 6", 3, 19, "from 0 to 1"},
    {"[spectrum]\nrange_nm = [300, 720]", 3, 13, "from 360 to 830 nm, found 300"},
    {"[spectrum]\nrange_nm = [720, 390]", 3, 12, "from below to"},
    {"[spectrum]\nrange_nm = [390, 500, 720]", 3, 12, "[from, to]"},
    {"[spectrum]\nsamples = 0", 3, 11, "a whole number from 1 to 256, found 0"},
    {"[spectrum]\nsamples = 2.5", 3, 11, "a whole number"},
    {"[tracing]\ntolerance = 1e-14", 3, 13, "above 1e-14 and below 0.01 rad"},
    {"[tracing]\ntolerance = 0.01", 3, 13, "above 1e-14 and below 0.01 rad"},
    {"[tracing]\nmethod = \"rk4\"", 3, 10, "did you mean 'rk45'?"},
    {"[tracing]\nquality = { sp = 4 }", 3, 13, "unknown key 'tracing.quality.sp' (did you mean 'spp'?)"},
    {"[tracing]\nquality = 64", 3, 11, "expected a table, found 64"},
    {"[tracing]\nmax_steps = 1", 3, 13, "from 10 to"},
    {"[atmosphere]\nsurface = \"round\"", 3, 11, "one of sphere, flat"},
    {"[atmosphere]\ndispersion = \"cauchy\"", 3, 14, "born-wolf, iag1999, ciddor, peck-reeder"},
    {"[atmosphere]\nprofile = \"us67\"", 3, 11, "did you mean 'us76'?"},
    {"[atmosphere]\nradius_km = 0", 3, 13, "km, found 0"},
    {"[atmosphere]\nexaggerate = -1", 3, 14, "above 0"},
    {"[atmosphere]\naerosol = { visibility_km = 60, turbidity = 2 }", 3, 45, "either visibility_km or turbidity"},
    {"[atmosphere]\naerosol = { visibility_km = 0 }", 3, 29, "above 0"},
    {"[atmosphere]\naerosol = { turbidity = 0.5 }", 3, 25, "from 1 to 100"},
    {"[atmosphere]\nfield = { kind = \"layers\" }", 3, 9, "belongs to scenes with a [camera]"},
    {"[camera]\nfrom = [0, 0, 0]", 2, 1, "belongs to scenes with a [camera]"},
    {"[[mesh]]\nfile = \"room.obj\"\n[photons]\nemitted = 3", 2, 1, "belongs to scenes with a [camera]"},
    {"[eye]\nmodel = \"eagle\"", 3, 9, "one of human, camera, none"},
    {"[eye]\nbleaching = { seconds = -1 }", 3, 25, "from 0 to"},
    {"[output]\nimage = \"flash.png\"", 3, 9, "ends in .exr"},
    {"[[sweep]]\nkey = \"sun.altitude\"\nvalues = [1]", 3, 7, "did you mean 'sun.altitude_deg'?"},
    {"[[sweep]]\nkey = \"sun.altitude_deg\"", 2, 1, "missing key 'sweep.range'"},
    {"[[sweep]]\nkey = \"sun.altitude_deg\"\nvalues = []", 4, 10, "at least one number"},
    {"[[sweep]]\nkey = \"sun.altitude_deg\"\nrange = { from = 0, to = 1, step = -1 }", 4, 36, "the right sign"},
    {"[[sweep]]\nkey = \"sun.altitude_deg\"\nrange = { from = 0, to = 1, step = 0 }", 4, 36, "not 0"},
    {"[[sweep]]\nkey = \"sun.altitude_deg\"\nrange = { from = 0, to = 1 }", 4, 9, "missing key 'sweep.range.step'"},
};

// oracle: line and column counted by hand in each text; ranges and words of the file format
// tolerance: none
TEST(SceneFile, SaysWhereAndWhatWasExpected) {
  for (const Wrong &wrong : wrong_scenes) {
    SCOPED_TRACE(wrong.text);
    const std::vector<Diagnostic> all = complaints("greenray = 1\n" + std::string(wrong.text));
    EXPECT_EQ(all.size(), 1u) << (all.empty() ? "" : InputError(all).what());
    if (all.empty()) continue;
    EXPECT_EQ(all[0].place.file, "my.toml");
    EXPECT_EQ(all[0].place.line, wrong.line) << all[0].text();
    EXPECT_EQ(all[0].place.column, wrong.column) << all[0].text();
    EXPECT_NE(all[0].message.find(wrong.says), std::string::npos) << all[0].text();
  }
}

// oracle: the format version is 1 and required
// tolerance: none
TEST(SceneFile, WantsTheFormatVersion) {
  for (const char *text : {"title = \"x\"", "greenray = 2", "greenray = \"1\""}) {
    const auto all = complaints(text);
    ASSERT_EQ(all.size(), 1u) << text;
    EXPECT_EQ(all[0].place.line, 1);
    EXPECT_NE(all[0].message.find("greenray"), std::string::npos) << all[0].text();
  }
}

// oracle: the mistakes made, in the scene first, then in its profile
// tolerance: none
TEST(SceneFile, ReportsSceneAndProfileTogether) {
  const TemporaryFolder folder;
  const std::string profile = folder.write("air.toml", "smooth_m = -1\n");
  const std::string file = folder.write("s.toml",
                                        "greenray = 1\na = 1\nb = 2\n[atmosphere]\nprofile = \"air.toml\"\n"
                                        "[observer]\nc = 3\n");
  try {
    load_scene(file);
    FAIL();
  } catch (const InputError &error) {
    const auto &all = error.diagnostics();
    ASSERT_EQ(all.size(), 4u) << error.what();
    EXPECT_EQ(all[0].place.line, 2);
    EXPECT_EQ(all[1].place.line, 3);
    EXPECT_EQ(all[2].place.line, 7);
    EXPECT_EQ(all[3].place.file, profile);
    EXPECT_EQ(all[3].place.column, 12);
    EXPECT_EQ(error.exit_code(), ExitCode::bad_input);
  }
}

// oracle: a name that is neither a file nor shipped
// tolerance: none
TEST(SceneFile, UnknownSceneListsTheShippedOnes) {
  try {
    load_scene("no-such-scene");
    FAIL();
  } catch (const InputError &error) {
    EXPECT_NE(std::string(error.what()).find("neither a scene file nor a shipped scene"), std::string::npos);
  }
  EXPECT_THROW(load_scene(""), InputError);
  for (const std::string &name : shipped_scenes()) {
    const std::string file = "scenes/" + name + ".toml", text(embedded_file(file).value());
    if (is_room_text(file, text)) EXPECT_NO_THROW(parse_room(file, text, {})) << name;
    else EXPECT_NO_THROW(load_scene(name)) << name;
  }
}

}  // namespace
}  // namespace greenray
