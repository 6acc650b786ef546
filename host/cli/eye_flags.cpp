#include "cli/eye_flags.hpp"

#include <charconv>
#include <cmath>

#include "support/error.hpp"

namespace greenray::cli {

using namespace vision;

std::vector<Flag> pupil_flags() {
  return {{"--pupil", "", "MODEL", "watson-yellott (default) | de-groot | moon-spencer | g04 (as printed, too small)"},
          {"--age", "", "YEARS", "of the observer, 20 to 83 (28.58): pupil and glare"},
          {"--eyes", "", "N", "1 or 2 (2): the pupil of one eye stays wider"}};
}

std::vector<Flag> eye_flags() {
  std::vector<Flag> flags{
      {"--ldmax", "", "CDM2", "brightest white of the display (100)"},
      {"--contrast", "", "RATIO", "of the display, white over black (100)"},
      {"--sensitivity", "", "on|off", "contrast no better than the eye sees in the scene (on)"},
      {"--glare", "", "on|off", "light scattered in the eye, CIE 135/1 (on)"},
      {"--acuity", "", "on|off", "detail lost in the dark (on)"},
      {"--colour", "", "on|off|cie191", "colour lost in the dark (on: Ward 1997; cie191: mesopic luminance)"},
      {"--bleaching", "", "off|steady|S", "pigment bleached by steady light, or by S seconds of looking (off)"},
      {"--bleach-model", "", "MODEL", "catch (default) | shape | threshold | adapted"},
      {"--bleach-pool", "", "pixel|disk",
       "each place by itself, or the bright disk as one, as a wandering gaze does (pixel)"},
      {"--bleach-luminance", "", "keep|fall", "bleaching changes colours only, or luminance too (keep)"},
      {"--neural", "", "K", "model adapted: share of the loss that the nerves make up for, 0 to 1 (1)"},
      {"--pigmentation", "", "P", "of the iris, for glare: 0 black, 0.5 brown, 1 green, 1.2 light blue (0.5)"},
      {"--surround", "", "CDM2", "light around the picture (as along its frame)"},
      {"--fov", "", "DEG", "horizontal field of view (as the picture says, else 40 for its smaller side)"},
      {"--magnification", "", "X", "of a telescope before the eye (1)"}};
  for (Flag &flag : pupil_flags()) flags.push_back(std::move(flag));
  return flags;
}

bool on_or_off(const Arguments &a, const std::string &flag, bool otherwise) {
  return a.choice(flag, {"on", "off"}, otherwise ? "on" : "off") == "on";
}

PupilModel pupil_model(const Arguments &a) {
  const std::string word = a.choice("--pupil", {"watson-yellott", "de-groot", "moon-spencer", "g04"}, "watson-yellott");
  if (word == "de-groot") return PupilModel::de_groot;
  if (word == "moon-spencer") return PupilModel::moon_spencer;
  return word == "g04" ? PupilModel::g04 : PupilModel::watson_yellott;
}

Display display_from(const Arguments &a) {
  Display display;
  display.max_cd_m2 = a.optional_number("--ldmax", 1e-3, 1e6, "cd/m2").value_or(100);
  display.contrast = a.optional_number("--contrast", 1.01, 1e9, "").value_or(100);
  return display;
}

static BleachingOptions bleaching_from(const Arguments &a) {
  BleachingOptions options;
  const std::string word = a.text("--bleaching", "off");
  if (word == "steady") {
    options.exposure = BleachingOptions::Exposure::steady;
  } else if (word != "off") {
    double seconds = 0;
    const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), seconds);
    if (status != std::errc() || end != word.data() + word.size() || !(seconds >= 0) || seconds > 1e7)
      a.fail("--bleaching", "expected off, steady, or seconds from 0 to 1e7");
    options.exposure = BleachingOptions::Exposure::seconds;
    options.seconds = seconds;
  }
  const std::string model = a.choice("--bleach-model", {"catch", "shape", "threshold", "adapted"}, "catch");
  options.model = model == "shape"       ? BleachModel::shape
                  : model == "threshold" ? BleachModel::threshold
                  : model == "adapted"   ? BleachModel::adapted
                                         : BleachModel::catch_;
  options.pooled = a.choice("--bleach-pool", {"pixel", "disk"}, "pixel") == "disk";
  options.dims = a.choice("--bleach-luminance", {"keep", "fall"}, "keep") == "fall";
  options.neural = a.optional_number("--neural", 0, 1, "").value_or(1);
  return options;
}

EyeOptions eye_options(const Arguments &a) {
  EyeOptions options;
  options.display = display_from(a);
  options.sensitivity = on_or_off(a, "--sensitivity", true);
  options.glare = on_or_off(a, "--glare", true);
  options.acuity = on_or_off(a, "--acuity", true);
  const std::string colour = a.choice("--colour", {"on", "off", "cie191"}, "on");
  options.rods = colour == "on" ? RodVision::ward : colour == "off" ? RodVision::off : RodVision::cie191;
  options.bleaching = bleaching_from(a);
  options.pupil = pupil_model(a);
  options.eye.age_years = a.optional_number("--age", 20, 83, "years").value_or(28.58);
  options.eye.pigmentation = a.optional_number("--pigmentation", 0, 1.5, "").value_or(0.5);
  options.eyes = a.choice("--eyes", {"1", "2"}, "2") == "1" ? 1 : 2;
  options.fov_deg = a.optional_number("--fov", 1e-4, 179, "deg");
  options.magnification = a.optional_number("--magnification", 1e-3, 1e4, "").value_or(1);
  if (options.fov_deg && *options.fov_deg * options.magnification > 179)
    a.fail("--magnification", "expected a field of view of at most 179 deg at the eye");
  options.surround_cd_m2 = a.optional_number("--surround", 0, 1e10, "cd/m2");
  if (const auto threads = a.optional_number("--threads", 1, 65536, ""))
    options.threads = static_cast<unsigned>(*threads);
  if (a.has("--mem")) {
    const auto bytes = parse_size(a.text("--mem"));
    if (!bytes) a.fail("--mem", "expected a size such as 512M or 6G");
    options.memory_bytes = *bytes;
  }
  options.map_greener = a.has("--greener");
  return options;
}

}  // namespace greenray::cli
