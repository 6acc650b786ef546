#include "render/pixel_statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "support/error.hpp"

namespace greenray {

namespace {
constexpr int enough_passes = 4;             // below, a pixel's variance from pass to pass is off by 40 % and more
constexpr double bias_of_difference = 2.77;  // see totals()
constexpr std::size_t block = 8;             // pixels
constexpr double difference_variance = 0.5;  // of one pass, over that of the wider kernel
}  // namespace

double pass_radius_ratio(int pass, double alpha) {
  double area = 1;
  for (int i = 1; i <= pass; ++i) area *= (i + alpha) / (i + 1);
  return std::sqrt(area);
}

const std::array<std::vector<double> PixelStatistics::*, 6> PixelStatistics::parts{
    &PixelStatistics::radiance_, &PixelStatistics::sum_,      &PixelStatistics::squares_,
    &PixelStatistics::narrower_, &PixelStatistics::variance_, &PixelStatistics::differences_};

PixelStatistics::PixelStatistics(std::size_t pixels, std::size_t waves)
    : pixels_(pixels),
      waves_(waves),
      radiance_(pixels * waves),
      sum_(pixels),
      squares_(pixels),
      narrower_(pixels),
      variance_(pixels),
      differences_(pixels) {}

void PixelStatistics::add(const PassPixels &pass) {
  if (pass.radiance.size() != radiance_.size() || pass.narrower.size() != pixels_ || pass.variance.size() != pixels_)
    throw RunError("a pass of another size than the picture");
  for (std::size_t p = 0; p < pixels_; ++p) {
    double sum = 0;
    for (std::size_t w = 0; w < waves_; ++w) {
      const double value = static_cast<double>(pass.radiance[p * waves_ + w]);
      radiance_[p * waves_ + w] += value;
      sum += value;
    }
    sum_[p] += sum;
    squares_[p] += sum * sum;
    narrower_[p] += static_cast<double>(pass.narrower[p]);
    variance_[p] += static_cast<double>(pass.variance[p]);
    const double difference = sum - static_cast<double>(pass.narrower[p]);
    differences_[p] += difference * difference;
  }
  ++passes_;
}

void PixelStatistics::add(const PixelStatistics &later) {
  if (later.pixels_ != pixels_ || later.waves_ != waves_) throw RunError("passes of another size than the picture");
  for (std::vector<double> PixelStatistics::*part : parts)
    for (std::size_t i = 0; i < (this->*part).size(); ++i) (this->*part)[i] += (later.*part)[i];
  passes_ += later.passes_;
}

void PixelStatistics::place(const PixelStatistics &part, std::size_t first) {
  if (first + part.pixels_ > pixels_ || part.waves_ != waves_)
    throw RunError("passes of another size than the picture");
  for (std::vector<double> PixelStatistics::*sums : parts) {
    const std::size_t each = sums == &PixelStatistics::radiance_ ? waves_ : 1;
    std::copy((part.*sums).begin(), (part.*sums).end(),
              (this->*sums).begin() + static_cast<std::ptrdiff_t>(first * each));
  }
  passes_ = part.passes_;
}

PixelStatistics PixelStatistics::part(std::size_t first, std::size_t last) const {
  PixelStatistics out(last - first, waves_);
  for (std::vector<double> PixelStatistics::*sums : parts) {
    const std::size_t each = sums == &PixelStatistics::radiance_ ? waves_ : 1;
    (out.*sums).assign((this->*sums).begin() + static_cast<std::ptrdiff_t>(first * each),
                       (this->*sums).begin() + static_cast<std::ptrdiff_t>(last * each));
  }
  out.passes_ = passes_;
  return out;
}

std::vector<float> PixelStatistics::mean() const {
  std::vector<float> mean(radiance_.size());
  const double n = std::max(passes_, 1);
  std::transform(radiance_.begin(), radiance_.end(), mean.begin(), [&](double x) { return static_cast<float>(x / n); });
  return mean;
}

/// Square of the standard error of pixel p, from at least `enough` passes or from within them.
double PixelStatistics::noise2(std::size_t p, int enough) const {
  const double n = std::max(passes_, 1);
  if (passes_ < enough) return variance_[p] / (n * n);
  return std::max(0.0, (squares_[p] - sum_[p] * sum_[p] / n) / std::max(n - 1, 1.0) / n);
}

std::vector<float> PixelStatistics::noise() const {
  std::vector<float> noise(pixels_);
  for (std::size_t p = 0; p < pixels_; ++p) noise[p] = static_cast<float>(std::sqrt(noise2(p, enough_passes)));
  return noise;
}

std::vector<float> PixelStatistics::bias() const {
  std::vector<float> bias(pixels_);
  const double n = std::max(passes_, 1);
  for (std::size_t p = 0; p < pixels_; ++p) bias[p] = static_cast<float>(2 * (sum_[p] - narrower_[p]) / n);
  return bias;
}

double PixelStatistics::Totals::error_rms() const { return std::hypot(noise_rms, bias_rms); }

PixelStatistics::Totals PixelStatistics::totals(std::span<const unsigned char> counts, std::size_t columns) const {
  const std::vector<float> bias_of = bias();
  const double n = std::max(passes_, 1);
  double pixels = 0, whole = 0, whole2 = 0, squares = 0, bias2 = 0, bias_sum = 0;
  const std::size_t across = (columns + block - 1) / block;
  std::vector<double> block_bias2(columns > 0 ? across * (pixels_ / columns / block + 1) : pixels_),
      block_pixels(block_bias2);
  for (std::size_t p = 0; p < pixels_; ++p) {
    if (!counts.empty() && !counts[p]) continue;
    const double difference = (sum_[p] - narrower_[p]) / n;
    const double spread =
        passes_ > 1 ? (differences_[p] / n - difference * difference) / (n - 1) : difference_variance * variance_[p];
    pixels += 1, whole += sum_[p] / n, whole2 += sum_[p] * sum_[p] / (n * n);
    // Two passes do for the mean of many pixels, and see more than the photons: edges, glass.
    squares += noise2(p, 2), bias_sum += static_cast<double>(bias_of[p]);
    bias2 += difference * difference - spread;
    const std::size_t at = columns > 0 ? p / columns / block * across + p % columns / block : p;
    block_bias2[at] += difference * difference - spread, block_pixels[at] += 1;
  }
  if (!(whole > 0)) return {};
  const double level = whole / pixels;
  double scatter = 0;  // variance of the sum
  for (std::size_t i = 0; i < block_bias2.size(); ++i)
    scatter += std::pow(block_bias2[i] - bias2 / pixels * block_pixels[i], 2);
  Totals totals;
  totals.noise_rms = std::sqrt(squares / pixels) / level;
  totals.bias_rms = bias_of_difference * std::sqrt(std::max(bias2, 0.0) / pixels) / level;
  totals.bias_below = bias_of_difference * std::sqrt((std::max(bias2, 0.0) + 2 * std::sqrt(scatter)) / pixels) / level;
  if (totals.bias_rms < 0.7 * totals.bias_below) totals.bias_rms = 0;
  totals.level_rms = std::sqrt(std::max(whole2 - squares, 1e-3 * whole2) / pixels) / level;
  totals.bias = bias_sum / pixels / level;
  return totals;
}

std::vector<double> PixelStatistics::state() const {
  std::vector<double> state{static_cast<double>(passes_)};
  state.reserve(state_size());
  for (std::vector<double> PixelStatistics::*part : parts)
    state.insert(state.end(), (this->*part).begin(), (this->*part).end());
  return state;
}

void PixelStatistics::restore(std::span<const double> state) {
  if (state.size() != state_size() || !(state[0] >= 0) || state[0] > 1e9)
    throw RunError("the checkpoint is of another picture");
  passes_ = static_cast<int>(state[0]);
  auto from = state.begin() + 1;
  for (std::vector<double> PixelStatistics::*part : parts) {
    std::copy_n(from, (this->*part).size(), (this->*part).begin());
    from += static_cast<std::ptrdiff_t>((this->*part).size());
  }
}

}  // namespace greenray
