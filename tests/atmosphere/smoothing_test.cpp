// The Gaussian over T(h), whichever quadrature serves it.
#include <gtest/gtest.h>

#include <cmath>

#include "atmosphere/gauss_hermite.hpp"
#include "atmosphere/standard_atmosphere.hpp"
#include "atmosphere/temperature_curve.hpp"

namespace greenray {
namespace {

/// Trapezoidal sum over +-9 sigma in steps of sigma/64: for analytic functions as good as rounding allows.
double brute_mean(const ProfileSpec &spec, double height_m) {
  ProfileSpec sharp = spec;
  sharp.smooth_m = 0;
  const TemperatureCurve curve(sharp);
  double sum = 0, weight = 0;
  for (int k = -576; k <= 576; ++k) {
    const double x = k / 64.0, w = std::exp(-0.5 * x * x);
    sum += w * curve(height_m + spec.smooth_m * x).value, weight += w;
  }
  return sum / weight;
}

}  // namespace

TEST(GaussHermite, MomentsOfTheNormalDistribution) {
  // oracle: the mean of x^(2k) is (2k - 1)!!
  // tolerance: rounding, growing with the moment
  for (int n : {5, 12, 40}) {
    const GaussHermite rule(n);
    ASSERT_EQ(static_cast<int>(rule.node.size()), n);
    double expected = 1;
    for (int k = 0; k <= std::min(n - 1, 12); ++k) {
      double even = 0, odd = 0;
      for (std::size_t i = 0; i < rule.node.size(); ++i) {
        even += rule.weight[i] * std::pow(rule.node[i], 2 * k);
        odd += rule.weight[i] * std::pow(rule.node[i], 2 * k + 1);
      }
      EXPECT_NEAR(even / expected, 1, 1e-12) << n << " " << k;
      EXPECT_NEAR(odd / expected, 0, 1e-10) << n << " " << k;
      expected *= 2 * k + 1;
    }
  }
}

TEST(Smoothing, OfStepsAndSurfaceLayersOfEveryWidth) {
  // oracle: a trapezoidal sum over the sharp profile, finer than any of its features
  // tolerance: 1e-10 K: rounding of a temperature of 300 K, and the tails beyond 7 sigma (1e-12 of the step)
  for (double width_m : {0.5, 1.9, 2.0, 3.0, 4.0, 5.0, 20.0}) {
    ProfileSpec spec;
    spec.smooth_m = 2;
    spec.inversions.push_back({});
    spec.inversions[0].delta_T_K = 8, spec.inversions[0].height_m = 120, spec.inversions[0].diffuseness_m = width_m;
    const TemperatureCurve curve(spec);
    for (double h : {20.0, 60.0, 100.0, 113.0, 119.5, 120.0, 121.0, 126.0, 140.0, 400.0, 3000.0})
      EXPECT_NEAR(curve(h).value, brute_mean(spec, h), 1e-10) << width_m << " " << h;
  }
  for (double scale_m : {3.0, 5.0, 30.0}) {
    ProfileSpec spec;
    spec.smooth_m = 2;
    spec.surface_layers.push_back({});
    spec.surface_layers[0].delta_T_K = 5, spec.surface_layers[0].scale_m = scale_m;
    const TemperatureCurve curve(spec);
    for (double h : {18.5, 25.0, 90.0}) EXPECT_NEAR(curve(h).value, brute_mean(spec, h), 1e-10) << scale_m << " " << h;
  }
}

}  // namespace greenray
