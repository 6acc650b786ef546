#include "render/pixel_statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "support/error.hpp"

namespace greenray {

namespace {
constexpr int enough_passes = 4;  // below, a pixel's variance from pass to pass is off by 40 % and more
}

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
      variance_(pixels) {}

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
  }
  ++passes_;
}

std::vector<float> PixelStatistics::mean() const {
  std::vector<float> mean(radiance_.size());
  const double n = std::max(passes_, 1);
  std::transform(radiance_.begin(), radiance_.end(), mean.begin(), [&](double x) { return static_cast<float>(x / n); });
  return mean;
}

std::vector<float> PixelStatistics::noise() const {
  std::vector<float> noise(pixels_);
  const double n = std::max(passes_, 1);
  for (std::size_t p = 0; p < pixels_; ++p) {
    const double between = (squares_[p] - sum_[p] * sum_[p] / n) / std::max(n - 1, 1.0) / n;
    noise[p] =
        static_cast<float>(std::sqrt(std::max(0.0, passes_ >= enough_passes ? between : variance_[p] / (n * n))));
  }
  return noise;
}

std::vector<float> PixelStatistics::bias() const {
  std::vector<float> bias(pixels_);
  const double n = std::max(passes_, 1);
  for (std::size_t p = 0; p < pixels_; ++p) bias[p] = static_cast<float>(2 * (sum_[p] - narrower_[p]) / n);
  return bias;
}

PixelStatistics::Totals PixelStatistics::totals() const {
  const std::vector<float> noise_of = noise(), bias_of = bias();
  double whole = 0, noise2 = 0, bias2 = 0, bias_sum = 0;
  for (std::size_t p = 0; p < pixels_; ++p) {
    const double e = static_cast<double>(noise_of[p]), b = static_cast<double>(bias_of[p]);
    whole += sum_[p] / std::max(passes_, 1);
    noise2 += e * e, bias2 += b * b, bias_sum += b;
  }
  const double n = static_cast<double>(std::max<std::size_t>(pixels_, 1)), level = whole / n;
  if (!(level > 0)) return {};
  return {std::sqrt(noise2 / n) / level, std::sqrt(bias2 / n) / level, bias_sum / n / level};
}

std::vector<double> PixelStatistics::state() const {
  std::vector<double> state{static_cast<double>(passes_)};
  for (const std::vector<double> *part : {&radiance_, &sum_, &squares_, &narrower_, &variance_})
    state.insert(state.end(), part->begin(), part->end());
  return state;
}

void PixelStatistics::restore(std::span<const double> state) {
  if (state.size() != 1 + radiance_.size() + 4 * pixels_ || !(state[0] >= 0) || state[0] > 1e9)
    throw RunError("the checkpoint is of another picture");
  passes_ = static_cast<int>(state[0]);
  auto from = state.begin() + 1;
  for (std::vector<double> *part : {&radiance_, &sum_, &squares_, &narrower_, &variance_}) {
    std::copy_n(from, part->size(), part->begin());
    from += static_cast<std::ptrdiff_t>(part->size());
  }
}

}  // namespace greenray
