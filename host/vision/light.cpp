#include "vision/light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "image/colour.hpp"
#include "support/fast_math.hpp"
#include "vision/cones.hpp"
#include "vision/tone_curve.hpp"

namespace greenray::vision {

namespace {

std::vector<float> as_floats(const std::vector<double> &values) { return {values.begin(), values.end()}; }

GREENRAY_VECTOR_CLONES void add_weighted(const float *from, float weight, std::size_t count, float *to) {
  for (std::size_t i = 0; i < count; ++i) to[i] += weight * from[i];
}

/// Values outside [0, limit], NaN among them.
GREENRAY_VECTOR_CLONES int count_outside(const float *row, std::size_t count, float limit) {
  int outside = 0;
  for (std::size_t x = 0; x < count; ++x) outside += row[x] >= 0.0F && row[x] <= limit ? 0 : 1;
  return outside;
}

/// A picture of one wavelength is a band 1 nm wide.
std::vector<float> single_wavelength(double value) { return {static_cast<float>(value)}; }

}  // namespace

void LightFaults::add(const LightFaults &other) {
  not_a_number += other.not_a_number;
  infinite += other.infinite;
  negative += other.negative;
  too_bright += other.too_bright;
}

LightConverter::LightConverter(const PictureFacts &facts) : spectral_(facts.spectral()) {
  if (!spectral_) return;
  const std::vector<double> &nm = facts.wavelength_nm;
  if (nm.size() == 1) {
    const Xyz colour = colour_matching(nm[0], ColourMatching::cie2015);
    for (const double value : {colour[0], colour[1], colour[2], colour_matching(nm[0])[1]})
      weights_.push_back(single_wavelength(luminous_efficacy_lm_W * value));
    weights_.push_back(single_wavelength(scotopic_weights({nm[0] - 1, nm[0], nm[0] + 1})[1]));
    return;
  }
  const SpectralWeights colour = spectral_weights(nm, ColourMatching::cie2015);
  for (const std::vector<double> *plane : {&colour.x, &colour.y, &colour.z}) weights_.push_back(as_floats(*plane));
  weights_.push_back(as_floats(spectral_weights(nm).y));
  weights_.push_back(as_floats(scotopic_weights(nm)));
}

LightFaults LightConverter::convert(std::vector<float> &raw, std::size_t width, std::size_t rows,
                                    float infinite_becomes_cd_m2, std::vector<float> &light) const {
  const std::size_t count = width * rows;
  if (spectral_) {
    light.assign(5 * count, 0.0F);
    for (std::size_t plane = 0; plane < 5; ++plane)
      for (std::size_t k = 0; k < weights_[plane].size(); ++k)
        if (weights_[plane][k] != 0)  // 0 x infinity would be NaN
          add_weighted(raw.data() + k * count, weights_[plane][k], count, light.data() + plane * count);
  } else {
    light.swap(raw);
  }
  return clean(width, rows, infinite_becomes_cd_m2, light);
}

/// Most rows are right and pass with one look at each value.
LightFaults LightConverter::clean(std::size_t width, std::size_t rows, float infinite_becomes_cd_m2,
                                  std::vector<float> &light) const {
  const std::size_t count = width * rows, channels = planes();
  const float most = static_cast<float>(brightest_cd_m2);
  LightFaults faults;
  for (std::size_t y = 0; y < rows; ++y) {
    float *row[5];
    for (std::size_t c = 0; c < channels; ++c) row[c] = light.data() + c * count + y * width;
    const float *luminance = row[luminance_plane()];
    int outside = count_outside(luminance, width, most);
    for (std::size_t c = 0; c < channels; ++c) outside += count_outside(row[c], width, 3e38F);
    if (outside == 0) continue;
    std::vector<std::size_t> holes;
    for (std::size_t x = 0; x < width; ++x) {
      bool nan = false, infinite = false;
      for (std::size_t c = 0; c < channels; ++c) {
        nan = nan || std::isnan(row[c][x]) || row[c][x] == -std::numeric_limits<float>::infinity();
        infinite = infinite || row[c][x] == std::numeric_limits<float>::infinity();
      }
      if (nan) {
        ++faults.not_a_number;
        holes.push_back(x);
      } else if (infinite) {
        ++faults.infinite;
        const float white[5] = {0.9505F, 1.0F, 1.0891F, 1.0F, static_cast<float>(scotopic_per_photopic_d65)};
        for (std::size_t c = 0; c < channels; ++c) row[c][x] = infinite_becomes_cd_m2 * white[c];
      } else if (luminance[x] < 0 || row[1][x] < 0) {
        ++faults.negative;
        for (std::size_t c = 0; c < channels; ++c) row[c][x] = 0;
      } else {
        if (luminance[x] > most) {
          ++faults.too_bright;
          const float scale = most / luminance[x];
          for (std::size_t c = 0; c < channels; ++c) row[c][x] *= scale;
        }
        for (std::size_t c = 0; c < channels; ++c) row[c][x] = row[c][x] > 0 ? row[c][x] : 0.0F;
      }
    }
    if (holes.empty()) continue;
    std::vector<char> hole(width, 0);
    for (const std::size_t x : holes) hole[x] = 1;
    for (const std::size_t x : holes) {
      std::size_t from = x;
      for (std::size_t d = 1; d < width && hole[from]; ++d) {
        if (d <= x && !hole[x - d]) from = x - d;
        else if (x + d < width && !hole[x + d]) from = x + d;
      }
      for (std::size_t c = 0; c < channels; ++c) row[c][x] = hole[from] ? 0.0F : row[c][from];
    }
  }
  return faults;
}

std::vector<float> linear_rgb(const std::vector<float> &light, std::size_t count) {
  std::vector<float> rgb(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const Rgb colour = rgb_from_xyz({static_cast<double>(light[i]), static_cast<double>(light[count + i]),
                                     static_cast<double>(light[2 * count + i])});
    for (std::size_t c = 0; c < 3; ++c) rgb[3 * i + c] = static_cast<float>(colour[c]);
  }
  return rgb;
}

LightStore::LightStore(PictureSource &source, std::size_t budget_bytes)
    : source_(source),
      converter_(source.facts()),
      width_(static_cast<std::size_t>(source.facts().width)),
      height_(static_cast<std::size_t>(source.facts().height)) {
  const std::size_t pixels = width_ * height_;
  if (converter_.planes() * pixels * sizeof(float) <= budget_bytes)
    kept_.reset(new float[converter_.planes() * pixels]);
}

LightFaults LightStore::load(int first, int rows, std::vector<float> &light) {
  std::vector<float> raw;
  source_.read(first, rows, raw);
  const auto count_rows = static_cast<std::size_t>(rows);
  const LightFaults faults = converter_.convert(raw, width_, count_rows, infinite_becomes_cd_m2_, light);
  const std::size_t count = width_ * count_rows;
  for (std::size_t plane = 0; kept_ && plane < converter_.planes(); ++plane)
    std::copy_n(light.data() + plane * count, count,
                kept_.get() + width_ * (plane * height_ + static_cast<std::size_t>(first)));
  return faults;
}

}  // namespace greenray::vision
