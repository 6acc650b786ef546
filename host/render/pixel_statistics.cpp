#include "render/pixel_statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "support/error.hpp"

namespace greenray {

namespace {
constexpr int enough_passes = 4;             // below, a pixel's variance from pass to pass is off by 40 % and more
constexpr double bias_of_difference = 2.77;  // see totals()
constexpr double difference_variance = 0.5;  // of one pass, over that of the wider kernel
}  // namespace

double pass_radius_ratio(int pass, double alpha) {
  double area = 1;
  for (int i = 1; i <= pass; ++i) area *= (i + alpha) / (i + 1);
  return std::sqrt(area);
}

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

PixelStatistics::Totals PixelStatistics::totals(std::span<const unsigned char> counts) const {
  const std::vector<float> bias_of = bias();
  const double n = std::max(passes_, 1);
  double pixels = 0, whole = 0, squares = 0, bias2 = 0, bias_sum = 0;
  for (std::size_t p = 0; p < pixels_; ++p) {
    if (!counts.empty() && !counts[p]) continue;
    const double difference = (sum_[p] - narrower_[p]) / n;
    const double spread =
        passes_ > 1 ? (differences_[p] / n - difference * difference) / (n - 1) : difference_variance * variance_[p];
    pixels += 1, whole += sum_[p] / n;
    // Two passes do for the mean of many pixels, and see more than the photons: edges, glass.
    squares += noise2(p, 2), bias_sum += static_cast<double>(bias_of[p]);
    bias2 += difference * difference - spread;
  }
  if (!(whole > 0)) return {};
  const double level = whole / pixels;
  return {std::sqrt(squares / pixels) / level, bias_of_difference * std::sqrt(std::max(bias2, 0.0) / pixels) / level,
          bias_sum / pixels / level};
}

std::vector<double> PixelStatistics::state() const {
  std::vector<double> state{static_cast<double>(passes_)};
  for (const std::vector<double> *part : {&radiance_, &sum_, &squares_, &narrower_, &variance_, &differences_})
    state.insert(state.end(), part->begin(), part->end());
  return state;
}

void PixelStatistics::restore(std::span<const double> state) {
  if (state.size() != 1 + radiance_.size() + 5 * pixels_ || !(state[0] >= 0) || state[0] > 1e9)
    throw RunError("the checkpoint is of another picture");
  passes_ = static_cast<int>(state[0]);
  auto from = state.begin() + 1;
  for (std::vector<double> *part : {&radiance_, &sum_, &squares_, &narrower_, &variance_, &differences_}) {
    std::copy_n(from, part->size(), part->begin());
    from += static_cast<std::ptrdiff_t>(part->size());
  }
}

}  // namespace greenray
