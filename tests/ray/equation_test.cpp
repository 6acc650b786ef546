// The pieces a ray is made of: look-ups in a cell, the ray equation, the way to the edge, Earth flattening.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

template <class Twin>
class Equation : public ::testing::Test {
 protected:
  static constexpr double eps = std::numeric_limits<typename Twin::Scalar>::epsilon();
};
using Twins = ::testing::Types<Single, Double>;
TYPED_TEST_SUITE(Equation, Twins);

TYPED_TEST(Equation, LooksUpTheCellsPolynomials) {
  // oracle: the polynomials of index_table.h written out with pow in double; ln n by Simpson's rule, exact for cubics
  // tolerance: 8 roundings of the largest term
  using Twin = TypeParam;
  const auto in = smooth_cell_ray<Twin>();
  const auto m = layers_of<Twin>(in, usual_absorbers<Twin>());
  const double rounding = TestFixture::eps;
  const auto g = [&](double t) {
    double sum = 0;
    for (int k = 0; k < 4; ++k) sum += static_cast<double>(in.cell.gradient[k]) * std::pow(t, k);
    return sum;
  };
  for (double t : {0.0, 0.1, 0.37, 0.5, 0.875, 1.0}) {
    const auto s = static_cast<typename Twin::Scalar>(t);
    const double exact_t = static_cast<double>(s);
    EXPECT_NEAR(Twin::gradient(m.cell, s), g(exact_t), 8 * rounding * 1e-7);
    double slope = 0, rho = 0;
    for (int k = 0; k < 4; ++k) {
      if (k) slope += k * static_cast<double>(in.cell.gradient[k]) * std::pow(exact_t, k - 1);
      rho += static_cast<double>(in.cell.density[k]) * std::pow(exact_t, k);
    }
    EXPECT_NEAR(Twin::gradient_slope(m.cell, s), slope, 8 * rounding * 2e-7);
    EXPECT_NEAR(Twin::density(m.cell, s), rho, 8 * rounding * 1.2);
    const double integral = 400 * exact_t / 6 * (g(0) + 4 * g(exact_t / 2) + g(exact_t));
    EXPECT_NEAR(Twin::log_index(m.cell, s), static_cast<double>(in.cell.log_index) + integral, 8 * rounding * 2.7e-4);
  }
}

TYPED_TEST(Equation, ForceIsTheSlopeOfHalfTheSquaredIndex) {
  // oracle: Hamilton's equations of eq 3.4: d(rise)/dsigma = d(N^2/2)/dz at fixed energy, N^2 = exp(2 potential) scaled
  // to
  //         the ray's N^2; d(z)/dsigma = rise; d(path)/dsigma = N^2; differences of the potential taken in double
  // tolerance: 20 roundings; central difference over 2 m of a cubic adds 1e-6 relative
  using Twin = TypeParam;
  const auto in = smooth_cell_ray<Twin>();
  const auto m = layers_of<Twin>(in, usual_absorbers<Twin>());
  const auto slope = Twin::derivative(m, state_of<Twin>(in));
  const auto exact = layers_of<Double>(smooth_cell_ray<Double>(), usual_absorbers<Double>());
  const double dpotential = (Double::potential(exact, 31) - Double::potential(exact, 29)) / 2;
  const double run = static_cast<double>(in.run), rise = static_cast<double>(in.rise);
  const double momentum2 = run * run + rise * rise;
  const double relative = 20 * TestFixture::eps + 1e-6;
  EXPECT_EQ(slope.above_m, in.rise);
  EXPECT_NEAR(slope.optical_path_m, momentum2, relative * momentum2);
  EXPECT_NEAR(slope.rise, momentum2 * dpotential, relative * 1.6e-7);
  EXPECT_NEAR(slope.bending_rad, -run * (dpotential - 1 / 6371000.0), relative * 1.6e-7);
  const double path = std::exp(130 / 6371000.0) * std::sqrt(momentum2);
  EXPECT_NEAR(slope.column[0], Double::density(exact.cell, 30.0 / 400) * path, relative * 1.2);
  EXPECT_NEAR(slope.column[1], std::exp(-0.5 * std::pow((130.0 - 22000) / 5000, 2)) * path,
              50 * TestFixture::eps * 1e-3);
  EXPECT_NEAR(slope.column[2], std::exp(-130.0 / 1200) * path, relative);
}

TYPED_TEST(Equation, FindsTheEdgeAhead) {
  // oracle: the ray itself, followed for that sigma in 64 steps of order 5
  // tolerance: 1e-3 of the 8 m to go: a series to third order, in a cell whose force changes by 5 % over them
  using Twin = TypeParam;
  using Scalar = typename Twin::Scalar;
  for (double rise : {0.002, 0.02, 0.5, -0.002, -0.02, -0.5}) {
    const auto in = smooth_cell_ray<Twin>(rise > 0 ? 392 : 8, rise);
    const auto m = layers_of<Twin>(in, usual_absorbers<Twin>());
    auto y = state_of<Twin>(in);
    const Scalar sigma = Twin::to_edge(m, y, rise > 0);
    Scalar error;
    for (int i = 0; i < 64; ++i) y = Twin::dormand_prince(m, y, sigma / Scalar(64), &error);
    // A falling ray that turns before the edge is taken to its turning point instead.
    if (std::abs(y.rise) < 0.02 * std::abs(rise)) continue;
    EXPECT_NEAR(y.above_m, rise > 0 ? 400 : 0, 0.008) << "rise " << rise;
  }
}

TYPED_TEST(Equation, FindsTheTurningPointWhenItComesFirst) {
  // oracle: the rise is zero where a ray turns
  // tolerance: 1 % of the start's rise, the third-order term of a parabola that falls 2 m of 400
  using Twin = TypeParam;
  using Scalar = typename Twin::Scalar;
  const auto in = smooth_cell_ray<Twin>(200, -0.0007);
  const auto m = layers_of<Twin>(in, usual_absorbers<Twin>());
  auto y = state_of<Twin>(in);
  const Scalar sigma = Twin::to_edge(m, y, false);
  Scalar error;
  for (int i = 0; i < 64; ++i) y = Twin::dormand_prince(m, y, sigma / Scalar(64), &error);
  EXPECT_NEAR(y.rise, 0, 0.01 * 0.0007);
  EXPECT_GT(y.above_m, 190);
}

TEST(Flattening, IsTheLogarithmOfTheRadiusAndInvertsItself) {
  // oracle: R ln(1 + h/R) in long double; flat: identity
  // tolerance: 4 roundings of double
  for (double h : {0.0, 1e-3, 2.0, 1000.0, 120000.0, 400000.0}) {
    const long double radius = 6371000.0L;
    const double z = f64::flattened_height_m(h, 1 / 6371000.0);
    EXPECT_NEAR(z, static_cast<double>(radius * log1pl(h / radius)), 1e-15 * h);
    EXPECT_NEAR(f64::geometric_height_m(z, 1 / 6371000.0), h, 1e-15 * h);
    EXPECT_EQ(f64::flattened_height_m(h, 0), h);
    EXPECT_EQ(f64::geometric_height_m(h, 0), h);
  }
}

}  // namespace
}  // namespace greenray
