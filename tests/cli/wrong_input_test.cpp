// Wrong command lines, scenes, profiles and soundings: exit 2, a place, what was expected, and nothing left behind.
// Long because it is one table.
#include <algorithm>
#include <ostream>
#include <regex>

#include "cli/tool.hpp"
#include "image/exr.hpp"

namespace greenray::cli_tests {
namespace {

/// Text of a file to be made, and the file's name.
struct File {
  std::string name, text;
};

/// One wrong input. `at` is the word that the complaint must point at, in `where`: "command line" or a file's name;
/// "" is its beginning (1:1), "$" the end of the command line. `says` must be in the complaint.
struct Wrong {
  std::string name;
  Words words;
  std::string where, at, says;
  std::vector<File> files{};
};

void PrintTo(const Wrong &wrong, std::ostream *out) { *out << wrong.name; }

std::string with(std::string text, const std::string &old, const std::string &now) {
  const std::size_t at = text.find(old);
  if (at == std::string::npos) throw std::logic_error("no '" + old + "' in the text");
  return text.replace(at, old.size(), now);
}

std::string joined(const Words &words) {
  std::string text = "greenray";
  for (const std::string &word : words) text += " " + word;
  return text;
}

/// oracle: where the wrong word stands in the text itself
std::string expected_place(const Wrong &wrong) {
  std::string text = joined(wrong.words);
  for (const File &file : wrong.files)
    if (file.name == wrong.where) text = file.text;
  if (wrong.at == "$") return wrong.where + ":1:" + std::to_string(text.size() + 2) + ": ";
  const std::size_t at = text.find(wrong.at);
  if (at == std::string::npos) throw std::logic_error("the test's word '" + wrong.at + "' is not in the text");
  const auto line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 1;
  const std::size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  const std::size_t column = before == std::string::npos ? at + 1 : at - before;
  return wrong.where + ":" + std::to_string(line) + ":" + std::to_string(column) + ": ";
}

const Words refraction{"refraction", "us76", "--height", "2", "--altitudes", "0", "--wavelengths", "550"};

/// The right refraction command with words of one flag replaced, more words after it.
Words refraction_with(const std::string &flag, const std::string &value, const Words &more = {}) {
  Words words = refraction;
  for (std::size_t i = 0; i + 1 < words.size(); ++i)
    if (words[i] == flag) words[i + 1] = value;
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

std::vector<Wrong> wrong_command_lines() {
  const std::string line = "command line";
  const File good{"s.toml", small_scene};
  return {
      {"UnknownCommand", {"rendr", "smoke"}, line, "rendr", "did you mean 'render'?"},
      {"UnknownHelpTopic", {"help", "nosuch"}, line, "nosuch", "greenray --help"},
      {"RenderWithoutScene", {"render"}, line, "$", "expected SCENE"},
      {"RenderTwoScenes", {"render", "smoke", "flat-sun"}, line, "flat-sun", "one word too many"},
      {"UnknownScene", {"render", "smoek"}, line, "smoek", "did you mean 'smoke'?"},
      {"UnknownSceneInCheck", {"check", "nosuch.toml"}, line, "nosuch.toml", "shipped: "},
      {"UnknownFlag", {"render", "smoke", "--sed=3"}, line, "--sed", "see `greenray render --help`"},
      {"MissingValue", {"render", "smoke", "--seed"}, line, "--seed", "needs a value: expected --seed N"},
      {"ValueIsAFlag", {"render", "smoke", "--size", "--quick"}, line, "--size", "expected --size WxH"},
      {"SeedIsAWord", {"render", "smoke", "--seed=x"}, line, "--seed=x", "expected a number from 0"},
      {"FlagTwice",
       {"render", "smoke", "--seed", "1", "--seed", "2"},
       line,
       "--seed 2",
       "given twice: expected it once"},
      {"SwitchTwice", {"check", "smoke", "-q", "--quiet"}, line, "--quiet", "given twice"},
      {"SwitchWithValue", {"render", "smoke", "--quick=yes"}, line, "--quick=yes", "expected no value"},
      {"SizeOfOneNumber", {"render", "smoke", "--size", "30"}, line, "30", "expected WxH"},
      {"SizeOfNothing", {"render", "smoke", "--size", "0x3"}, line, "0x3", "expected 1x1 to 16384x16384"},
      {"SizeHuge", {"render", "smoke", "--size", "99999x99999"}, line, "99999x", "expected 1x1 to 16384x16384"},
      {"SamplesZero", {"render", "smoke", "--spp", "0"}, line, "0", "expected a number from 1"},
      {"ErrorNegative", {"render", "smoke", "--error", "-1"}, line, "-1", "percent"},
      {"CropOfThree", {"render", "smoke", "--crop", "1,2,3"}, line, "1,2,3", "expected X0,Y0,X1,Y1"},
      {"CropOutside", {"render", "smoke", "--crop", "0,0,161,120"}, line, "0,0,161", "inside the picture of 160x120"},
      {"CropOutsideQuick", {"check", "smoke", "--quick", "--crop", "0,0,41,1"}, line, "0,0,41", "of 40x30"},
      {"CropEmpty", {"render", "smoke", "--crop", "5,5,5,9"}, line, "5,5,5,9", "inside the picture"},
      {"OutputIsPng", {"render", "smoke", "-o", "out/x.png"}, line, "out/x.png", "ends in .exr"},
      {"MemoryUnit", {"render", "smoke", "--mem", "3Q"}, line, "3Q", "expected a size such as 512M or 6G"},
      {"MemoryZero", {"render", "smoke", "--mem", "0"}, line, "0", "expected a size"},
      {"Lanes", {"render", "smoke", "--lanes", "3"}, line, "3", "expected 1 | 4 | 8"},
      {"Threads", {"render", "smoke", "--threads", "none"}, line, "none", "expected a number from 1"},
      {"CheckUnknownFlag", {"check", "smoke", "--josn"}, line, "--josn", "did you mean '--json'?"},
      {"SceneNewExists", {"new", "s.toml"}, line, "s.toml", "expected a new file name", {good}},
      {"SceneNewOfAnotherKind", {"new", "deep/s.txt"}, line, "deep/s.txt", "ends in .toml"},
      {"SceneNewWithoutName", {"new"}, line, "$", "expected FILE.toml"},
      {"ScenesWithWord", {"scenes", "smoke"}, line, "smoke", "expected `greenray scenes` and flags"},
      {"DevicesUnknownFlag", {"devices", "--tset"}, line, "--tset", "did you mean '--test'?"},
      {"UnknownProfile",
       {"refraction", "us67", "--height=2", "--altitudes=0", "--wavelengths=550"},
       line,
       "us67",
       "did you mean 'us76'?"},
      {"MissingHeight", {"refraction", "us76", "--altitudes=0", "--wavelengths=550"}, line, "$", "missing --height M"},
      {"HeightBelowGround", refraction_with("--height", "-0.5"), line, "-0.5", "m above the surface"},
      {"HeightNotANumber", refraction_with("--height", "nan"), line, "nan", "expected a number"},
      {"HeightBeyondDoubles", refraction_with("--height", "1e400"), line, "1e400", "expected a number"},
      {"HeightWithUnit", refraction_with("--height", "2m"), line, "2m", "expected a number"},
      {"ListStepZero", refraction_with("--altitudes", "1:2:0"), line, "1:2:0", "step must lead from FROM to TO"},
      {"ListStepBackwards", refraction_with("--altitudes", "1:2:-1"), line, "1:2:-1", "step must lead"},
      {"ListOfTwoInRange", refraction_with("--altitudes", "0:1"), line, "0:1", "FROM:TO:STEP"},
      {"ListWithHole", refraction_with("--altitudes", "1,,2"), line, "1,,2", "expected a,b,c"},
      {"ListEndsInComma", refraction_with("--altitudes", "1,2,"), line, "1,2,", "expected a,b,c"},
      {"ListEmpty",
       {"refraction", "us76", "--height=2", "--altitudes=", "--wavelengths=550"},
       line,
       "--altitudes=",
       "expected a,b,c"},
      {"ListTooLong", refraction_with("--altitudes", "0:1:1e-9"), line, "0:1:1e-9", "at most 10000000 values"},
      {"AltitudeBeyondZenith", refraction_with("--altitudes", "0,91"), line, "0,91", "91 is out of range"},
      {"WavelengthInMicrometres", refraction_with("--wavelengths", "0.55"), line, "0.55", "200 to 2000 [nm]"},
      {"MethodUnknown", refraction_with("", "", {"--method", "euler"}), line, "euler",
       "auto | rk | richardson | cells"},
      {"PrecisionUnknown", refraction_with("", "", {"--precision", "doubel"}), line, "doubel",
       "did you mean 'double'?"},
      {"ToleranceZero", refraction_with("", "", {"--tolerance", "0.0"}), line, "0.0", "[arcsec]"},
      {"FormatUnknown", refraction_with("", "", {"--format", "xml"}), line, "xml", "expected csv | json"},
      {"TraceWithoutDistances",
       {"trace", "us76", "--height=2", "--altitudes=0", "--wavelengths=550"},
       line,
       "$",
       "missing --distances LIST"},
      {"TraceDistanceNegative",
       {"trace", "us76", "--height=2", "--altitudes=0", "--wavelengths=550", "--distances", "-4"},
       line,
       "-4",
       "m along the surface"},
      {"TraceSurface",
       {"trace", "us76", "--height=2", "--altitudes=0", "--wavelengths=550", "--distances=4", "--surface", "flta"},
       line,
       "flta",
       "did you mean 'flat'?"},
      {"TracePlotIsPng",
       {"trace", "us76", "--height=2", "--altitudes=0", "--wavelengths=550", "--distances=4", "--plot", "a.png"},
       line,
       "a.png",
       "ends in .svg"},
      {"TracePlotOfAPoint",
       {"trace", "us76", "--height=2", "--altitudes=0", "--wavelengths=550", "--distances=0", "--plot", "a.svg"},
       line,
       "a.svg",
       "expected a distance above 0"},
      {"ProfileWithoutLists", {"profile", "us76"}, line, "", "missing --heights LIST"},
      {"ProfileBelowGround",
       {"profile", "us76", "--heights", "-5,3", "--wavelengths", "550"},
       line,
       "-5,3",
       "-5 is out of range"},
      {"ProfileAboveAir", {"profile", "us76", "--heights", "2e5", "--wavelengths", "550"}, line, "2e5", "120000"},
      {"ProfileOutputIsText", {"profile", "us76", "-o", "air.txt"}, line, "air.txt", "ends in .toml"},
      {"ProfilePlotIsPng", {"profile", "us76", "--plot", "new/air.png"}, line, "new/air.png", "ends in .svg"},
      {"ProfileSurfaceKey",
       {"profile", "us76", "--heights=3", "--wavelengths=550", "--surface-layer", "water=3"},
       line,
       "water=3",
       "did you mean 'water_C'?"},
      {"ProfileSurfaceValue",
       {"profile", "us76", "--heights=3", "--wavelengths=550", "--surface-layer", "water_C=3,top_m=x"},
       line,
       "water_C=3",
       "top_m 'x' is not a number"},
      {"ProfileFileMissing",
       {"profile", "nosuch.csv", "--heights=3", "--wavelengths=550"},
       line,
       "nosuch.csv",
       "shipped: "},
      {"CompareOne", {"compare", "a.exr"}, line, "$", "expected A.exr B.exr"},
      {"CompareLimit", {"compare", "a.exr", "b.exr", "--max-rms", "-1"}, line, "-1", "cd/m2"},
      {"DevelopWithoutOutput", {"develop", "a.exr"}, line, "a.exr", "missing --output OUT.png"},
      {"DevelopObserver", {"develop", "a.exr", "-o", "b.png", "--observer", "eagle"}, line, "eagle", "expected human"},
      {"BenchSuite", {"bench", "nosuch"}, line, "nosuch", "expected a suite"},
      {"BenchWithoutFile", {"bench", "trace", "--json"}, line, "--json", "needs a value"},
      {"BenchCompareOne", {"bench", "--compare", "a.json"}, line, "a.json", "expected two files"},
      {"BenchCompareMissing", {"bench", "--compare", "a.json", "b.json"}, "a.json", "", "expected a file written by"},
  };
}

/// Pictures to be refused are made as the test starts.
std::string exr_bytes(int width) {
  const fs::path file = fs::temp_directory_path() / ("greenray-wrong-" + std::to_string(::getpid()) + ".exr");
  RgbImage image{width, 2, std::vector<float>(static_cast<std::size_t>(width) * 6, 1.0F)};
  write_exr(file, image);
  const std::string bytes = contents(file);
  fs::remove(file);
  return bytes;
}

std::vector<Wrong> wrong_pictures() {
  const File a{"a.exr", exr_bytes(3)}, b{"b.exr", exr_bytes(4)}, damaged{"d.exr", a.text.substr(0, a.text.size() - 9)};
  return {
      {"CompareMissing", {"compare", "a.exr", "b.exr"}, "b.exr", "", "expected an EXR file, found no such file", {a}},
      {"CompareSizes", {"compare", "a.exr", "b.exr"}, "a.exr", "", "expected a picture of 4x2", {a, b}},
      {"CompareDamaged", {"compare", "d.exr", "a.exr"}, "d.exr", "", "not a readable EXR file", {a, damaged}},
      {"DevelopDamaged", {"develop", "d.exr", "-o", "out/d.png"}, "d.exr", "", "not a readable EXR file", {damaged}},
      {"DevelopText",
       {"develop", "t.exr", "-o", "t.png"},
       "t.exr",
       "",
       "not a readable EXR file",
       {{"t.exr", "no picture\n"}}},
      {"DevelopMissing", {"develop", "a.exr", "-o", "new/t.png"}, "a.exr", "", "no such file"},
  };
}

/// The small scene with one thing changed; the complaint stands at `at`.
Wrong scene(const std::string &name, const std::string &old, const std::string &now, const std::string &at,
            const std::string &says, const Words &more = {}) {
  Words words{"render", "w.toml", "-o", "new/x.exr"};
  words.insert(words.end(), more.begin(), more.end());
  return {name, words, "w.toml", at, says, {{"w.toml", with(small_scene, old, now)}}};
}
Wrong scene_and(const std::string &name, const std::string &more, const std::string &at, const std::string &says) {
  return scene(name, "quality = { spp = 4 }", more, at, says);
}
Wrong override_of(const std::string &name, const std::string &assignment, const std::string &column,
                  const std::string &says) {
  Wrong wrong{name,
              {"check", "w.toml", "-D", assignment},
              "-D " + assignment + ":1:" + column,
              "!",
              says,
              {{"w.toml", small_scene}}};
  return wrong;
}

std::vector<Wrong> wrong_scenes() {
  return {
      scene("SceneVersion", "greenray = 1", "greenray = 2", "2", "version of the scene format"),
      scene("SceneWithoutVersion", "greenray = 1\n", "", "", "missing key 'greenray'"),
      scene("QuoteOpen", "low Sun\"", "low Sun", "\n[atm", "not valid TOML"),
      scene("BracketOpen", "[atmosphere]", "[atmosphere", "\nprofile", "expected ']'"),
      scene("EqualsMissing", "height_m = 2.0", "height_m 2.0", "2.0", "expected '='"),
      scene("KeyTwice", "samples = 2", "samples = 2\nsamples = 3", "3\n[tracing", "cannot redefine"),
      scene("UnknownKey", "height_m", "heigth_m", "heigth_m", "did you mean 'height_m'?"),
      scene("UnknownTable", "[observer]", "[obsrever]", "obsrever", "did you mean 'observer'?"),
      scene("HeightOfEyeBelowGround", "= 2.0", "= -2.0", "-2.0", "expected a number from 0 to 1e+07 m"),
      scene("HeightIsText", "= 2.0", "= \"2 m\"", "\"2 m\"", "found text"),
      scene("HeightNan", "= 2.0", "= nan", "nan", "expected a number"),
      scene("FieldOfView180", "0.8", "180", "180", "below 180 deg"),
      scene("ResolutionOne", "[16, 12]", "[16]", "[16]", "expected [width, height]"),
      scene("ResolutionNotWhole", "[16, 12]", "[16, 12.5]", "[16", "whole numbers of pixels"),
      scene("ResolutionNumber", "[16, 12]", "16", "16", "expected an array"),
      scene("ProfileUnknown", "us76", "us67", "\"us67", "did you mean 'us76'?"),
      scene("ProfileNumber", "\"us76\"", "76", "76", "expected text in quotes"),
      scene("SurfaceUnknown", "\"us76\"", "\"us76\"\nsurface = \"round\"", "\"round", "sphere, flat"),
      scene("RadiusNegative", "\"us76\"", "\"us76\"\nradius_km = -5", "-5", "km"),
      scene("AerosolTwice", "\"us76\"", "\"us76\"\naerosol = { visibility_km = 3, turbidity = 2 }", "2 }",
            "either visibility_km or turbidity"),
      scene("FieldNotBuilt", "\"us76\"", "\"us76\"\nfield = { kind = \"layers\" }", "{ kind", "with a [camera]"),
      scene("SunBelowHorizon", "deg = 0.2\n[spe", "deg = -0.9\n[spe", "-0.9", "the horizon is at -0.0414 deg"),
      scene("SunTwice", "deg = 0.2\n[spe", "deg = 0.2\naltitude_deg = 0.1\n[spe", "0.2\naltitude", "found more"),
      scene("SunByDate", "apparent_altitude_deg = 0.2", "when = 2024-06-21T20:31:05Z", "[sun]",
            "missing key 'sun.place'"),
      scene("SunByLocalDate", "apparent_altitude_deg = 0.2",
            "when = 2024-06-21T20:31:05\nplace = { latitude_deg = 48, longitude_deg = -5 }", "2024", "offset from UTC"),
      scene("SunWithoutAltitude", "apparent_altitude_deg = 0.2\n", "", "[sun]", "or apparent_altitude_deg"),
      scene("SunPart", "[spectrum]", "at = \"top\"\n[spectrum]", "\"top", "centre, upper-limb, lower-limb"),
      scene("SamplesNone", "samples = 2", "samples = 0", "0\n[tracing", "whole number from 1 to 256"),
      scene("RangeBackwards", "samples = 2", "range_nm = [700, 400]", "[700", "from below to"),
      scene("RangeOutside", "samples = 2", "range_nm = [300, 700]", "300", "from 360 to 830 nm"),
      scene_and("QualityZero", "quality = { spp = 0 }", "0 }", "whole number from 1"),
      scene_and("MethodOfTracing", "method = \"rk4\"", "\"rk4", "did you mean 'rk45'?"),
      scene_and("StepsFew", "max_steps = 3", "3", "10 to 1e+08 steps"),
      scene_and("CameraBesideObserver", "[camera]\nfrom = [0, 0, 1]", "observer]", "unknown key 'observer'"),
      scene_and("OutputPng", "[output]\nimage = \"a.png\"", "\"a.png", "ends in .exr"),
      scene_and("SweepKey", "[[sweep]]\nkey = \"sun.altitude_dge\"\nvalues = [1]", "\"sun.altitude_dge",
                "did you mean 'sun.altitude_deg'?"),
      override_of("OverrideKey", "obsever.height_m=3", "1", "did you mean 'observer'?"),
      override_of("OverrideForm", "observer.height_m", "1", "expected KEY=VALUE"),
      override_of("OverrideValue", "observer.height_m=abc", "19", "expected a number from 0"),
      {"SceneIsBinary", {"check", "b.toml"}, "b.toml", "", "not valid UTF-8", {{"b.toml", "\xff\xfe\n"}}},
      {"SceneIsEmpty", {"check", "e.toml"}, "e.toml", "", "missing key 'greenray'", {{"e.toml", ""}}},
      {"SceneWithWrongProfile",
       {"render", "w.toml"},
       "air/p.toml",
       "-1",
       "m, found -1",
       {{"w.toml", with(small_scene, "us76", "air/p.toml")}, {"air/p.toml", "smooth_m = -1\n"}}},
  };
}

Wrong profile(const std::string &name, const std::string &text, const std::string &at, const std::string &says) {
  return {name,     {"profile", "p.toml", "--heights=0", "--wavelengths=550", "-o", "new/q.toml"},
          "p.toml", at,
          says,     {{"p.toml", text}}};
}
Wrong sounding(const std::string &name, const std::string &file, const std::string &text, const std::string &at,
               const std::string &says, const Words &more = {}) {
  Words words{"profile", file, "--heights=0", "--wavelengths=550", "-o", "new/q.toml"};
  words.insert(words.end(), more.begin(), more.end());
  return {name, words, file, at, says, {{file, text}}};
}

std::vector<Wrong> wrong_profiles() {
  const std::string level = "[[level]]\nheight_m = 0\ntemperature_K = 288\n";
  const std::string inversion = "[[inversion]]\ndelta_T_K = 8\nheight_m = 50\ndiffuseness_m = 5\n";
  return {
      profile("AirKey", "bas = \"us76\"\n", "bas", "did you mean 'base'?"),
      profile("AirBase", "base = \"us67\"\n", "\"us67", "did you mean 'us76'?"),
      profile("AirBaseNone", "base = \"none\"\n", "\"none", "expects [[level]] rows"),
      profile("AirIndex", "index = \"cidor\"\n", "\"cidor", "did you mean 'ciddor'?"),
      profile("AirInterpolation", "interpolation = \"spline\"\n", "\"spline", "linear, cubic"),
      profile("AirSmoothUnit", "smooth_m = \"2 m\"\n", "\"2 m", "expected a number"),
      profile("AirUnquoted", "base = us76\n", "us76", "not valid TOML"),
      profile("AirExaggerate", "exaggerate = -1\n", "-1", "above 0"),
      profile("AirWithoutPressure", "surface_pressure_Pa = 0.0\n", "0.0", "above 0"),
      profile("AirMostlyVapour", "[[level]]\nheight_m = 0\ntemperature_K = 400\nrelative_humidity = 1\n", "",
              "most of the air vapour"),
      profile("LevelWithoutT", "[[level]]\nheight_m = 0\n", "", "missing key 'level.temperature_K'"),
      profile("LevelInCelsius", with(level, "288", "15"), "15", "100 to 2000 K"),
      profile("LevelWrongUnit", level + "temperature_F = 59\n", "temperature_F", "unknown key 'level.temperature_F'"),
      profile("LevelTwice", level + with(level, "288", "287"), "0\ntemperature_K = 287", "ascend from row to row"),
      profile("LevelBelowGround", with(level, "= 0", "= -1"), "-1", "from 0 to 120000 m"),
      profile("LevelHumidityPercent", level + "relative_humidity = 88.5\n", "88.5", "expected a number from 0 to 1"),
      profile("InversionIncomplete", with(inversion, "diffuseness_m = 5\n", ""), "", "missing key"),
      profile("InversionSharp", with(inversion, "= 5\n", "= 0.0\n"), "0.0", "from 0.001 to"),
      profile("InversionVariesTooCold",
              with(with(inversion, "= 50", "= { x_m = [0, 1e3], value = [50, 40] }"), "= 8", "= 400"), "",
              "stays above 0 K"),
      profile("InversionVariesBackwards", with(inversion, "= 50", "= { x_m = [1e3, 0], value = [50, 40] }"), "[1e3",
              "expected distances that ascend"),
      profile("InversionVariesAtNaN", with(inversion, "= 50", "= { x_m = [0, nan], value = [50, 40] }"), "nan",
              "expected a number"),
      profile("InversionVariesNowhere", with(inversion, "= 50", "= { value = [50, 40] }"), "{", "missing key"),
      profile("OneStation", "[[station]]\nx_m = 0\nprofile = \"us76\"\n", "[[station", "expected two stations or more"),
      profile("StationUnknown", "[[station]]\nx_m = 0\nprofile = \"us76\"\n[[station]]\nx_m = 9\nprofile = \"us67\"\n",
              "\"us67", "neither a file nor a shipped profile"),
      profile("StationsBackwards",
              "[[station]]\nx_m = 9\nprofile = \"us76\"\n[[station]]\nx_m = 0\nprofile = \"cold-sea\"\n", "0\nprofile",
              "expected distances to ascend"),
      profile("StationsBesideLevels",
              "[[station]]\nx_m = 0\nprofile = \"us76\"\n[[station]]\nx_m = 9\nprofile = \"cold-sea\"\n" + level,
              "[[level", "not allowed beside [[station]]"),
      profile("InversionVariesUnevenly", with(inversion, "= 50", "= { x_m = [0, 1e3], value = [50] }"), "[50]",
              "expected as many numbers as x_m has"),
      profile("InversionTooCold", with(inversion, "= 8", "= 400"), "", "stays above 0 K"),
      profile("InversionNotRows", with(inversion, "[[inversion]]", "[inversion]"), "", "begun by [[inversion]]"),
      profile("LayerIncomplete", "[[surface_layer]]\ndelta_T_K = 5\n", "", "missing key 'surface_layer.scale_m'"),
      profile("IndexAndAir", "[[index_level]]\nheight_m = 0\nrefractivity = 0.1\n" + level, "[[level",
              "takes the place of air"),
      profile("IndexIncomplete", "[[index_level]]\nheight_m = 0\n", "", "missing key 'index_level.refractivity'"),
  };
}

std::vector<Wrong> wrong_soundings() {
  const fs::path data = fs::path(GREENRAY_TEST_DATA) / "soundings";
  const std::string plain = contents(data / "profile_plain_synthetic.csv"),
                    igra = contents(data / "igra2_synthetic.txt");
  const std::string two_levels = igra.substr(0, igra.find('\n', igra.find('\n', igra.find('\n') + 1) + 1) + 1);
  const std::string seventh = "63,16.1,1009.4,77", eighth = "88,18.0,1006.4,68";
  const std::string shuffled = with(with(with(plain, seventh, "*"), eighth, seventh), "*", eighth);
  return {
      sounding("CsvEmpty", "s.csv", "", "", "found an empty file"),
      sounding("CsvOnlyComments", "s.csv", "# height above sea level\n", "", "expected a sounding"),
      sounding("CsvColumn", "s.csv", with(plain, "height_m,", "hight_m,"), "hight_m", "did you mean 'height_m'?"),
      sounding("CsvNumber", "s.csv", with(plain, "28,13.6", "28,1x.6"), "1x.6", "expected"),
      sounding("CsvShuffled", "s.csv", shuffled, "1009.4", "is a row misplaced or damaged?"),
      sounding("CsvBinary", "s.csv", "PK\x03\x04 zipped", "", "unzip it first"),
      sounding("ListTruncatedInName", "s.txt", "00001 XGRY Greenray Test Head\n", "", "expected"),
      sounding("IgraTruncated", "s.txt", two_levels,
               two_levels.substr(two_levels.rfind('\n', two_levels.size() - 2) + 1), "the file is truncated"),
      sounding("IgraStation", "s.txt", igra, "", "expected a sounding of station 'NOPE'", {"--station", "NOPE"}),
      sounding("IgraTime", "s.txt", igra, "", "choose by one of these", {"--when", "2030-01-01T00"}),
  };
}

std::vector<Wrong> all_wrong() {
  std::vector<Wrong> all;
  for (auto part : {wrong_command_lines, wrong_pictures, wrong_scenes, wrong_profiles, wrong_soundings})
    for (Wrong &wrong : part()) all.push_back(std::move(wrong));
  return all;
}

class WrongInput : public ToolTest, public ::testing::WithParamInterface<Wrong> {};

}  // namespace

// oracle: the contract (exit 2, nothing written) and the place of the wrong word in the text.  tolerance: none
TEST_P(WrongInput, ExitsTwoWithPlaceAndHint) {
  const Wrong &wrong = GetParam();
  for (const File &file : wrong.files) write(folder / file.name, file.text);
  const auto before = listing(folder);
  const Outcome result = run(wrong.words);
  EXPECT_EQ(result.code, 2) << joined(wrong.words) << "\n" << result.out << result.err;
  EXPECT_EQ(result.out, "") << joined(wrong.words);
  EXPECT_EQ(listing(folder), before) << "left something behind";
  const std::vector<std::string> complaints = lines_of(result.err);
  ASSERT_FALSE(complaints.empty());
  const std::regex form(R"(.+:[1-9]\d*:[1-9]\d*: .{12,})");
  for (const std::string &line : complaints) EXPECT_TRUE(std::regex_match(line, form)) << line;
  const std::string place = wrong.at == "!" ? wrong.where + ": " : expected_place(wrong);
  const bool found = std::any_of(complaints.begin(), complaints.end(), [&](const std::string &line) {
    return line.rfind(place, 0) == 0 && line.find(wrong.says) != std::string::npos;
  });
  EXPECT_TRUE(found) << "expected " << place << " .. " << wrong.says << "\nfound    " << result.err;
}

INSTANTIATE_TEST_SUITE_P(Table, WrongInput, ::testing::ValuesIn(all_wrong()),
                         [](const auto &one) { return one.param.name; });

}  // namespace greenray::cli_tests
