#include "image/develop.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <mutex>
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

Rgb pixel_at(const float *rgb, std::size_t i) {
  return {static_cast<double>(rgb[3 * i]), static_cast<double>(rgb[3 * i + 1]), static_cast<double>(rgb[3 * i + 2])};
}

constexpr double key_shares[2] = {0.995, 0.9998};  // of the lit pixels, ordered by their strongest channel
constexpr std::uint32_t low_bits = 15, bins = 1U << 16U, low_mask = (1U << low_bits) - 1;

/// Bin that holds the value of this rank; rank: becomes that within the bin.
std::uint32_t bin_of(const std::vector<std::uint64_t> &counts, std::uint64_t &rank) {
  std::uint32_t bin = 0;
  while (bin + 1 < counts.size() && rank >= counts[bin]) rank -= counts[bin++];
  return bin;
}

}  // namespace

/// Positive floats are ordered like their bits: first by the upper half of these, then by the lower half of two bins.
struct ExposureKey::State {
  std::mutex lock;
  std::vector<std::uint64_t> upper = std::vector<std::uint64_t>(bins, 0), lower[2];
  std::uint32_t bin[2] = {0, 0};
  std::uint64_t rank[2] = {0, 0}, lit = 0;
  int looks = 0;
  double value[2] = {0, 0};
};

ExposureKey::ExposureKey() : state_(new State) {}
ExposureKey::~ExposureKey() = default;

void ExposureKey::look(const float *rgb, std::size_t pixels) {
  State &s = *state_;
  std::vector<std::uint32_t> lit;
  for (std::size_t i = 0; i < pixels; ++i) {
    const Rgb value = pixel_at(rgb, i);
    if (is_light(value) && strongest(value) > 0)
      lit.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(strongest(value))));
  }
  const std::lock_guard<std::mutex> guard(s.lock);
  for (const std::uint32_t bits : lit) {
    if (s.looks == 0) ++s.upper[bits >> low_bits];
    else
      for (int k = 0; k < 2; ++k)
        if (bits >> low_bits == s.bin[k]) ++s.lower[k][bits & low_mask];
  }
  if (s.looks == 0) s.lit += lit.size();
}

bool ExposureKey::again() {
  State &s = *state_;
  if (++s.looks == 1) {
    for (int k = 0; k < 2 && s.lit > 0; ++k) {
      s.rank[k] = static_cast<std::uint64_t>(key_shares[k] * static_cast<double>(s.lit - 1));
      s.bin[k] = bin_of(s.upper, s.rank[k]);
      s.lower[k].assign(low_mask + 1, 0);
    }
    return s.lit > 0;
  }
  for (int k = 0; k < 2; ++k)
    s.value[k] = static_cast<double>(std::bit_cast<float>(s.bin[k] << low_bits | bin_of(s.lower[k], s.rank[k])));
  return false;
}

double ExposureKey::cd_m2() const { return std::sqrt(state_->value[0]) * std::sqrt(state_->value[1]); }

void camera_rows(const CameraOptions &options, CameraReport &report, const float *scene, std::size_t pixels,
                 float *display) {
  report.exposure_ev = options.exposure_ev.value_or(0.0);
  const double gain = report.key_cd_m2 > 0 ? std::exp2(report.exposure_ev) / report.key_cd_m2 : 0.0;
  for (std::size_t p = 0; p < pixels; ++p) {
    Rgb value = pixel_at(scene, p);
    const bool light = is_light(value);
    const double norm = light ? strongest(value) : 0;
    report.replaced += light ? 0 : 1;
    if (!(norm > 0)) {
      std::fill_n(display + 3 * p, 3, 0.0F);
      continue;
    }
    const double scale = film_curve(norm * gain) / norm;
    for (double &channel : value) channel *= scale;
    report.gamut_moved += map_into_gamut(value) ? 1 : 0;
    for (std::size_t c = 0; c < 3; ++c) display[3 * p + c] = static_cast<float>(value[c]);
  }
}

RgbImage camera_display(const RgbImage &scene, const CameraOptions &options, CameraReport &report) {
  report = {};
  ExposureKey key;
  do key.look(scene.rgb.data(), scene.pixels());
  while (key.again());
  report.key_cd_m2 = key.cd_m2();
  RgbImage display{scene.width, scene.height, std::vector<float>(scene.rgb.size())};
  camera_rows(options, report, scene.rgb.data(), scene.pixels(), display.rgb.data());
  return display;
}

CameraPicture develop_camera(const RgbImage &scene, const CameraOptions &options) {
  CameraPicture picture;
  const RgbImage display = camera_display(scene, options, picture.report);
  picture.pixels = quantise(display, options.bits, options.dither);
  return picture;
}

}  // namespace greenray
