// Noise and bias of pixels over passes: what is claimed, and what noise may hide.
#include "render/pixel_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace greenray {
namespace {

constexpr std::size_t columns = 64, rows = 48, pixels = columns * rows;

struct Made {
  PixelStatistics statistics{pixels, 1};
  double true_bias_rms = 0;  // over the mean
};

/// Passes over pixels of radiance 1: the wide kernel is off by bias (1 + sin), the one of half the area by half of it
/// less; both share noise, their difference has some of its own. A few pixels are `wild` times as noisy.
Made made(double bias, double noise, double wild, int passes, unsigned seed) {
  Made out;
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal(0, 1);
  std::vector<float> radiance(pixels), narrower(pixels), variance(pixels);
  double squares = 0;
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t p = 0; p < pixels; ++p) {
      const double here = bias * (1 + std::sin(0.05 * static_cast<double>(p % columns)));
      const double sigma = noise * (p % 97 == 0 ? wild : 1);
      const double common = sigma * normal(engine), own = sigma * normal(engine);
      radiance[p] = static_cast<float>(1 + here + common);
      narrower[p] = static_cast<float>(1 + here - here / 2.77 + common + own);
      variance[p] = static_cast<float>(sigma * sigma);
      squares += here * here / passes / static_cast<double>(pixels);
    }
    out.statistics.add({radiance, narrower, variance});
  }
  out.true_bias_rms = std::sqrt(squares);
  return out;
}

// oracle: the bias put in; a difference that is a 2.77th of it is what the estimate takes for it
// tolerance: 10 %: the noise of 3072 pixels and eight passes is a hundredth of the square
TEST(PixelStatistics, ABiasAboveTheNoiseIsFound) {
  const Made m = made(0.1, 0.05, 1, 8, 1);
  const PixelStatistics::Totals t = m.statistics.totals({}, columns);
  const double mean = 1 + 0.1 * 0.9;  // about: only the level of a ratio
  EXPECT_TRUE(t.bias_is_seen());
  EXPECT_NEAR(t.bias_rms * mean / m.true_bias_rms, 1, 0.1);
  EXPECT_GT(t.bias_below, t.bias_rms);
  EXPECT_NEAR(t.error_rms(), std::hypot(t.noise_rms, t.bias_rms), 1e-12);
}

// oracle: a bias of nothing under wild noise must not be claimed, nor may 0 be: what it is below holds in 19 of 20
// cases
//         (two standard errors); the same with a bias that the noise hides
// tolerance: of 60 runs at most 8 above, 3 expected (binomial, 99.5 %)
TEST(PixelStatistics, WhatNoiseHidesIsSaid) {
  for (const double bias : {0.0, 0.05, 0.2}) {
    int above = 0, claimed = 0;
    for (unsigned seed = 0; seed < 60; ++seed) {
      const Made m = made(bias, 0.1, 30, 4, 100 + seed);
      const PixelStatistics::Totals t = m.statistics.totals({}, columns);
      above += t.bias_below * 1.2 < m.true_bias_rms;  // 1.2: of the mean, which the bias raises
      claimed += t.bias_is_seen();
      EXPECT_GT(t.bias_below, 0.01) << "noise like this hides something";
      if (!t.bias_is_seen()) {
        EXPECT_EQ(t.error_rms(), t.noise_rms);
      }
    }
    EXPECT_LE(above, 12) << bias;
    if (bias == 0) {
      EXPECT_LE(claimed, 12) << "nothing claimed as something";
    }
  }
}

// oracle: half of the pixels shine with 1, the others not: the RMS is 2^(1/2) times the mean
// tolerance: 1 %
TEST(PixelStatistics, ErrorOverTheRmsOfThePicture) {
  PixelStatistics statistics(pixels, 1);
  std::vector<float> radiance(pixels), variance(pixels);
  std::mt19937 engine(9);
  std::normal_distribution<float> normal(0, 0.02f);
  for (int pass = 0; pass < 8; ++pass) {
    for (std::size_t p = 0; p < pixels; ++p) radiance[p] = (p % 2 ? 1.0f : 0.0f) + normal(engine);
    statistics.add({radiance, radiance, variance});
  }
  const PixelStatistics::Totals t = statistics.totals({}, columns);
  EXPECT_NEAR(t.error_of_rms() / t.error_rms(), std::sqrt(0.5), 0.01);
  EXPECT_NEAR(t.error_rms(), 0.02 / std::sqrt(8) / 0.5, 0.002);
}

}  // namespace
}  // namespace greenray
