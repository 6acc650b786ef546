#include "vision/planes.hpp"

#include <algorithm>
#include <cmath>

#include "support/fast_math.hpp"

namespace greenray::vision {

namespace {

/// Weights for offsets -r .. r.
std::vector<float> gaussian_taps(double variance) {
  const int radius = blur_radius(variance);
  std::vector<double> taps(static_cast<std::size_t>(2 * radius + 1));
  double sum = 0;
  for (int t = -radius; t <= radius; ++t) {
    // three taps have the right variance themselves; a sampled Gaussian so narrow would not
    const double tap = radius == 1 ? (t == 0 ? 1 - variance : 0.5 * variance) : std::exp(-0.5 * t * t / variance);
    taps[static_cast<std::size_t>(t + radius)] = tap;
    sum += tap;
  }
  std::vector<float> result;
  for (const double tap : taps) result.push_back(static_cast<float>(tap / sum));
  return result;
}

/// to[x] = sum_t taps[t] from[x + t]
GREENRAY_VECTOR_CLONES void convolve_row(const float *from, const float *taps, int count, int width, float *to) {
  for (int x = 0; x < width; ++x) to[x] = taps[0] * from[x];
  for (int t = 1; t < count; ++t)
    for (int x = 0; x < width; ++x) to[x] += taps[t] * from[x + t];
}

GREENRAY_VECTOR_CLONES void add_scaled(const float *from, float weight, int width, float *to) {
  for (int x = 0; x < width; ++x) to[x] += weight * from[x];
}

GREENRAY_VECTOR_CLONES void mix_rows(const float *a, const float *b, float t, int width, float *to) {
  for (int x = 0; x < width; ++x) to[x] = a[x] + t * (b[x] - a[x]);
}

}  // namespace

Plane halved(const Plane &fine, Beyond beyond) {
  Plane coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  const int pairs = fine.width / 2;
  const std::vector<float> nothing(static_cast<std::size_t>(fine.width), 0.0F);
  for (int y = 0; y < coarse.height; ++y) {
    const float *upper = fine.row(2 * y);
    const float *lower = 2 * y + 1 < fine.height  ? fine.row(2 * y + 1)
                         : beyond == Beyond::edge ? upper
                                                  : nothing.data();
    float *to = coarse.row(y);
    for (int x = 0; x < pairs; ++x) to[x] = 0.25F * (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1]);
    if (fine.width % 2)
      to[pairs] = (beyond == Beyond::edge ? 0.5F : 0.25F) * (upper[fine.width - 1] + lower[fine.width - 1]);
  }
  return coarse;
}

Plane halved_smoothly(const Plane &fine) {
  Plane coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  std::vector<float> down(static_cast<std::size_t>(fine.width + 4), 0.0F);  // one column before, three beyond
  for (int y = 0; y < coarse.height; ++y) {
    std::fill(down.begin(), down.end(), 0.0F);
    for (int t = -1; t <= 2; ++t)
      if (2 * y + t >= 0 && 2 * y + t < fine.height)
        add_scaled(fine.row(2 * y + t), t == 0 || t == 1 ? 0.375F : 0.125F, fine.width, down.data() + 1);
    float *to = coarse.row(y);
    for (int x = 0; x < coarse.width; ++x) {
      const float *from = down.data() + 2 * x;
      to[x] = 0.125F * (from[0] + from[3]) + 0.375F * (from[1] + from[2]);
    }
  }
  return coarse;
}

Plane doubled(const Plane &coarse, int width, int height, int first_row) {
  Plane fine(width, height);
  std::vector<float> mixed(static_cast<std::size_t>(coarse.width));
  const auto kept = [&](int y) { return coarse.row(std::clamp(y, 0, coarse.height - 1)); };
  for (int y = 0; y < height; ++y) {
    const int below = first_row + (y + 1) / 2;  // the pair of coarse rows around this fine row
    mix_rows(kept(below - 1), kept(below), y % 2 ? 0.25F : 0.75F, coarse.width, mixed.data());
    float *to = fine.row(y);
    for (int x = 0; x < width; ++x) {
      const int near = std::min(x / 2, coarse.width - 1);
      const int far = std::clamp(x % 2 ? near + 1 : near - 1, 0, coarse.width - 1);
      to[x] = 0.75F * mixed[static_cast<std::size_t>(near)] + 0.25F * mixed[static_cast<std::size_t>(far)];
    }
  }
  return fine;
}

int blur_radius(double variance) { return variance < 0.3 ? 1 : static_cast<int>(std::ceil(3.2 * std::sqrt(variance))); }

void add_blurred(const Plane &in, double variance, double weight, Plane &out) {
  const std::vector<float> taps = gaussian_taps(variance);
  const int radius = static_cast<int>(taps.size() / 2), count = static_cast<int>(taps.size());
  std::vector<float> padded(static_cast<std::size_t>(in.width + 2 * radius), 0.0F);
  std::vector<float> across(static_cast<std::size_t>(in.width));
  for (int y = 0; y < in.height; ++y) {
    std::copy_n(in.row(y), in.width, padded.begin() + radius);
    convolve_row(padded.data(), taps.data(), count, in.width, across.data());
    for (int t = -radius; t <= radius; ++t)
      if (y + t >= 0 && y + t < out.height)
        add_scaled(across.data(), static_cast<float>(weight) * taps[static_cast<std::size_t>(t + radius)], in.width,
                   out.row(y + t));
  }
}

}  // namespace greenray::vision
