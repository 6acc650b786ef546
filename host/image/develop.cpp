#include "image/develop.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "image/colour.hpp"

namespace greenray {

namespace {

constexpr double shadow_fill = 0.25;    // share of the lifted curve: a faint sky beside a Sun stays visible
constexpr double shadow_power = 0.6;    // its slope, stops shown per stop of scene
constexpr double shoulder_knee = 0.16;  // a pixel at the key is shown at 1 / (1 + knee) of white

/// Straight near the key, lifted in the shadows, with a shoulder that never quite reaches white. exposed: 1 at the key.
double film_curve(double exposed) {
  const double filled = (exposed + shadow_fill * std::pow(exposed, shadow_power)) / (1 + shadow_fill);
  return std::isinf(filled) ? 1.0 : filled / (filled + shoulder_knee);
}

/// A sensor has no negative light; negative parts of a positive colour are only outside Rec. 709 and are kept.
bool is_light(const Rgb &value) {
  const bool finite = std::all_of(value.begin(), value.end(), [](double v) { return std::isfinite(v); });
  return finite && luminance(value) >= 0;
}

double strongest(const Rgb &value) { return std::max({value[0], value[1], value[2], 0.0}); }

double exposure_key(const RgbImage &scene) {
  std::vector<double> lit;
  for (std::size_t p = 0; p < scene.pixels(); ++p) {
    const Rgb value = scene.pixel(p);
    if (is_light(value) && strongest(value) > 0) lit.push_back(strongest(value));
  }
  if (lit.empty()) return 0;
  const auto percentile = [&lit](double fraction) {
    const auto rank = static_cast<std::ptrdiff_t>(fraction * static_cast<double>(lit.size() - 1));
    std::nth_element(lit.begin(), lit.begin() + rank, lit.end());
    return lit[static_cast<std::size_t>(rank)];
  };
  const double high = percentile(0.995);
  return std::sqrt(high) * std::sqrt(percentile(0.9998));
}

}  // namespace

RgbImage camera_display(const RgbImage &scene, const CameraOptions &options, CameraReport &report) {
  report = {};
  report.key_cd_m2 = exposure_key(scene);
  report.exposure_ev = options.exposure_ev.value_or(0.0);
  const double gain = report.key_cd_m2 > 0 ? std::exp2(report.exposure_ev) / report.key_cd_m2 : 0.0;
  RgbImage display{scene.width, scene.height, std::vector<float>(scene.rgb.size())};
  for (std::size_t p = 0; p < scene.pixels(); ++p) {
    Rgb value = scene.pixel(p);
    if (!is_light(value)) {
      ++report.replaced;
      continue;
    }
    const double norm = strongest(value);
    if (!(norm > 0)) continue;
    const double scale = film_curve(norm * gain) / norm;
    for (double &channel : value) channel *= scale;
    report.gamut_moved += map_into_gamut(value) ? 1 : 0;
    display.set_pixel(p, value);
  }
  return display;
}

CameraPicture develop_camera(const RgbImage &scene, const CameraOptions &options) {
  CameraPicture picture;
  const RgbImage display = camera_display(scene, options, picture.report);
  picture.pixels = quantise(display, options.bits, options.dither);
  return picture;
}

}  // namespace greenray
