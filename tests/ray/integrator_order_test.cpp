// Order of convergence of both steppers by halving, in both precisions, until rounding.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

constexpr double curvature_per_m = 0.01, sigma_end = 6;
constexpr std::array<double, 4> gradient{-0.05, 0.2, -0.15, 0.05};

/// A laboratory cell: bends a ray by half a radian over 6 m, smooth, the ray stays within it.
template <class Twin>
typename Twin::ProbeIn laboratory_ray() {
  using Scalar = typename Twin::Scalar;
  auto in = smooth_cell_ray<Twin>(1.0, 0.1);
  for (std::size_t k = 0; k < 4; ++k) in.cell.gradient[k] = static_cast<Scalar>(gradient[k]);
  in.cell.bottom_m = Scalar(2);
  in.cell.thickness_m = Scalar(4);
  in.run = Scalar(1.25);
  return in;
}

struct Exact {
  long double above_m, rise, bending_rad, optical_path_m;
};

/// The same equation by classical Runge-Kutta in long double with 20000 steps, in this file's own words.
Exact exact_end(long double run, long double rise) {
  using Four = std::array<long double, 4>;
  const auto slope = [run](const Four &y) {
    const long double t = y[0] / 4;
    const long double g = gradient[0] + t * (gradient[1] + t * (gradient[2] + t * gradient[3]));
    const long double squared = run * run + y[1] * y[1];
    return Four{y[1], squared * (static_cast<long double>(curvature_per_m) + g), -run * g, squared};
  };
  const auto plus = [](Four y, long double h, const Four &k) {
    for (std::size_t i = 0; i < 4; ++i) y[i] += h * k[i];
    return y;
  };
  Four y{1, rise, 0, 0};
  const int steps = 20000;
  const long double h = static_cast<long double>(sigma_end) / steps;
  for (int i = 0; i < steps; ++i) {
    const Four a = slope(y), b = slope(plus(y, h / 2, a)), c = slope(plus(y, h / 2, b)), d = slope(plus(y, h, c));
    for (std::size_t k = 0; k < 4; ++k) y[k] += h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
  }
  return {y[0], y[1], y[2], y[3]};
}

template <class Twin, class Step>
double error_after(int steps, Step step) {
  using Scalar = typename Twin::Scalar;
  const auto in = laboratory_ray<Twin>();
  const auto m = layers_of<Twin>(in, usual_absorbers<Twin>(curvature_per_m));
  auto y = state_of<Twin>(in);
  Scalar error;
  for (int i = 0; i < steps; ++i) y = step(m, y, static_cast<Scalar>(sigma_end / steps), &error);
  const Exact exact = exact_end(in.run, in.rise);
  return static_cast<double>(
      std::max({std::abs(y.above_m - exact.above_m) / 4, std::abs(y.rise - exact.rise),
                std::abs(y.bending_rad - exact.bending_rad), std::abs(y.optical_path_m - exact.optical_path_m) / 10}));
}

/// Halves until rounding: each halving must divide the error by about 2^order. Returns the smallest error seen.
template <class Twin, class Step>
double expect_order(double order, int first_steps, Step step) {
  const double slack = 0.4, eps = std::numeric_limits<typename Twin::Scalar>::epsilon();
  double before = 0, smallest = 1;
  int measured = 0;
  for (int steps = first_steps; steps <= 8192; steps *= 2) {
    const double error = error_after<Twin>(steps, step);
    const double rounding = 20 * eps * (2 + std::sqrt(steps));  // of a sum of that many terms
    smallest = std::min(smallest, error);
    if (before > 0 && error > rounding) {
      EXPECT_GT(std::log2(before / error), order - slack) << steps << " steps, error " << error;
      ++measured;
    }
    if (error <= rounding) break;
    before = error;
  }
  EXPECT_GE(measured, 1);
  return smallest;
}

template <class Twin>
class Order : public ::testing::Test {};
using Twins = ::testing::Types<Single, Double>;
TYPED_TEST_SUITE(Order, Twins);

TYPED_TEST(Order, DormandPrinceIsFive) {
  // oracle: Dormand & Prince 1980, order 5; reference by another method in long double
  // tolerance: order within 0.4 from above rounding; ends within 300 roundings
  const double smallest = expect_order<TypeParam>(5, 1, TypeParam::dormand_prince);
  EXPECT_LT(smallest, 300 * std::numeric_limits<typename TypeParam::Scalar>::epsilon());
}

TYPED_TEST(Order, RichardsonIsThree) {
  // oracle: the extrapolated midpoint method has order 3 (G04 3.4 as richardson.h says)
  // tolerance: order within 0.4 from above rounding; double is stopped at 8192 steps, 1e-12
  const double smallest = expect_order<TypeParam>(3, 2, TypeParam::richardson);
  EXPECT_LT(smallest, TypeParam::is_double ? 1e-12 : 300 * std::numeric_limits<float>::epsilon());
}

TEST(ErrorEstimate, BoundsTheErrorOfTheStepThatIsKept) {
  // oracle: one step against 512 small ones from the same start
  // tolerance: none: an estimate of the lower order must exceed the error of the higher
  const auto in = laboratory_ray<Double>();
  const auto m = layers_of<Double>(in, usual_absorbers<Double>(curvature_per_m));
  for (double h : {1.0, 0.5, 0.25, 0.125}) {
    double dp_error = 0, richardson_error = 0, ignored = 0;
    const auto y = state_of<Double>(in);
    const auto by_dp = Double::dormand_prince(m, y, h, &dp_error);
    const auto by_richardson = Double::richardson(m, y, h, &richardson_error);
    auto fine = y;
    for (int i = 0; i < 512; ++i) fine = Double::dormand_prince(m, fine, h / 512, &ignored);
    EXPECT_GT(dp_error, std::abs(by_dp.rise - fine.rise)) << h;
    EXPECT_GT(dp_error, std::abs(by_dp.bending_rad - fine.bending_rad)) << h;
    EXPECT_GT(richardson_error, std::abs(by_richardson.rise - fine.rise)) << h;
    EXPECT_GT(richardson_error, std::abs(by_richardson.bending_rad - fine.bending_rad)) << h;
  }
}

}  // namespace
}  // namespace greenray
