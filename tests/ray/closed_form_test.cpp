// Rays whose answer is a formula, through the index table, the launch and the device: both precisions, both
// integrators.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "render/launch.hpp"
#include "support/angle.hpp"
#include "support_code/reference_table.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

using testing_data::ReferenceRow;
using testing_data::ReferenceTable;
using Vector = std::array<double, 3>;

double dot(const Vector &a, const Vector &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double length(const Vector &a) { return std::sqrt(dot(a, a)); }
Vector combine(double p, const Vector &a, double q, const Vector &b) {
  return {p * a[0] + q * b[0], p * a[1] + q * b[1], p * a[2] + q * b[2]};
}
Vector vector_of(const ReferenceRow &row, const std::array<const char *, 3> &columns) {
  return {row.number(columns[0]), row.number(columns[1]), row.number(columns[2])};
}
/// The part of `a` across the unit vector `up`, normalised; any perpendicular when there is none.
Vector across(const Vector &a, const Vector &up) {
  const Vector rest = combine(1, a, -dot(a, up), up);
  const double l = length(rest);
  return l > 1e-12 ? combine(1 / l, rest, 0, up) : Vector{0, 0, 0};
}

/// A medium by formula; lengths of the formula times `unit_m`.
LayeredMedium medium_of(std::function<Dual(double height_m)> refractivity, double top_m, double radius_m) {
  LayeredMedium medium;
  medium.refractivity = [f = std::move(refractivity)](double h, double) { return f(h); };
  medium.density_kg_m3 = [](double) { return 0.0; };
  medium.top_m = top_m;
  medium.radius_m = radius_m;
  return medium;
}

template <class Twin>
class ClosedForm : public ::testing::Test {
 protected:
  static TraceOptions options() {
    TraceOptions o;
    o.precision = Twin::precision;
    o.storage = TableStorage::buffer;
    o.with_columns = false;
    o.tolerance_rad = Twin::is_double ? 1e-14 : 1e-9;
    o.max_steps = 200000;
    return o;
  }
  static IndexTable table_of(const LayeredMedium &medium) {
    IndexTableOptions wanted;
    wanted.error_arcsec = Twin::is_double ? 1e-7 : 1e-3;
    return build_index_table(medium, {550}, wanted);
  }
  static std::vector<f64::RayEnd> trace(const IndexTable &table, const std::vector<f64::RayStart> &starts) {
    return RayTracer(shared_device(), table, options()).trace(starts);
  }
  static f64::RayEnd trace_one(const IndexTable &table, const f64::RayStart &start) { return trace(table, {start})[0]; }
  static double z_m(const IndexTable &table, const f64::RayEnd &end) {
    return table.cell(0, static_cast<std::size_t>(end.cell)).bottom_m + end.above_m;
  }
  static constexpr double relative = Twin::is_double ? 1e-9 : 2e-6;
};
using Twins = ::testing::Types<Single, Double>;
TYPED_TEST_SUITE(ClosedForm, Twins);

// One unit of the supplied tables: large, so that a table good to 1e-7 arcsec over a hundred kilometres is possible at
// all.
constexpr double unit_m = 1e5;

TYPED_TEST(ClosedForm, SquaredIndexLinearInHeight) {
  // oracle: supplied/analytic_linear_n2.csv, parabolas r(sigma) in three dimensions; each row is turned into the
  // vertical
  //         plane of its gradient and ray: height along the gradient, distance across it
  // tolerance: 1e-9 (float: 2e-6) of the unit for position, direction and optical path
  const ReferenceTable rows("supplied/analytic_linear_n2.csv");
  ASSERT_EQ(rows.rows().size(), 36u);
  for (const ReferenceRow &row : rows.rows()) {
    const Vector g = vector_of(row, {"gx", "gy", "gz"}), r0 = vector_of(row, {"x0", "y0", "z0"}),
                 d0 = vector_of(row, {"dx0", "dy0", "dz0"});
    const double steepness = length(g), sigma = row.number("sigma");
    const Vector up = combine(1 / steepness, g, 0, g), forward = across(d0, up);
    const double lowest = -1.2, floor_n2 = 2 + steepness * lowest;
    ASSERT_GT(floor_n2, 0.1);
    const auto refractivity = [&](double h) {
      const double n = std::sqrt(floor_n2 + steepness * h / unit_m);
      return Dual(n - 1, steepness / (2 * n * unit_m));
    };
    const IndexTable table = TestFixture::table_of(medium_of(refractivity, 3.2 * unit_m, 0));
    f64::RayStart start = launch(table, 0, (dot(r0, up) - lowest) * unit_m, std::asin(dot(d0, up)));
    start.sigma_end_m = sigma * unit_m;
    const f64::RayEnd end = TestFixture::trace_one(table, start);
    ASSERT_EQ(end.outcome, f64::RAY_IN_FLIGHT);

    const double rose = TestFixture::z_m(table, end) / unit_m + lowest - dot(r0, up),
                 went = end.run * end.sigma_m / unit_m;
    const Vector r1 = combine(1, r0, 1, combine(rose, up, went, forward));
    const double momentum = std::hypot(end.run, end.rise);
    const Vector d1 = combine(end.rise / momentum, up, end.run / momentum, forward);
    const double tolerance = TestFixture::relative;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::array<const char *, 3> place{"x1", "y1", "z1"}, direction{"dx1", "dy1", "dz1"};
      EXPECT_NEAR(r1[k], row.number(place[k]), tolerance);
      EXPECT_NEAR(d1[k], row.number(direction[k]), tolerance);
    }
    EXPECT_NEAR(end.optical_path_m / unit_m, row.number("opl"), tolerance);
    EXPECT_LT(end.bouguer_drift, tolerance);
  }
}

TYPED_TEST(ClosedForm, LuneburgLens) {
  // oracle: supplied/analytic_luneburg.csv, ellipses inside a sphere of n^2 = 2 - r^2; the medium here is the shell
  // outside
  //         an inner radius of 0.1; rays that dive below it would be skipped, but none of the 24 does
  // tolerance: 1e-9 (float: 4e-6) of the unit, for radius, direction, central angle, bending and optical path
  constexpr double inner = 0.1;
  const auto refractivity = [](double h) {
    const double r = inner + h / unit_m, n = std::sqrt(2 - r * r);
    return Dual(n - 1, -r / (n * unit_m));
  };
  const double radius_m = inner * unit_m;
  const IndexTable table = TestFixture::table_of(medium_of(refractivity, unit_m - radius_m, radius_m));
  const ReferenceTable rows("supplied/analytic_luneburg.csv");
  const double tolerance = 2 * TestFixture::relative;
  int traced = 0, skipped = 0, left = 0;
  for (const ReferenceRow &row : rows.rows()) {
    const Vector r0 = vector_of(row, {"x0", "y0", "z0"}), d0 = vector_of(row, {"dx0", "dy0", "dz0"}),
                 r1 = vector_of(row, {"x1", "y1", "z1"}), d1 = vector_of(row, {"dx1", "dy1", "dz1"});
    const double sigma = row.number("sigma"), inward = dot(r0, d0);
    const double deepest = sigma > pi / 4 ? pi / 4 : sigma;
    if (std::sqrt(1 + inward * std::sin(2 * deepest)) < 1.0001 * inner) {
      ++skipped;
      continue;
    }
    const bool leaves = sigma > 1.5707;
    const Vector forward = across(d0, r0);
    const double angle = std::atan2(dot(r1, forward), dot(r1, r0));
    const f64::RayStart start =
        launch(table, 0, unit_m - radius_m, std::asin(inward), leaves ? until_it_leaves : angle * radius_m);
    const f64::RayEnd end = TestFixture::trace_one(table, start);
    ASSERT_EQ(end.outcome, leaves ? f64::RAY_SPACE : f64::RAY_IN_FLIGHT);
    const double r = 1 / unit_m * radius_m * std::exp(TestFixture::z_m(table, end) / radius_m);
    EXPECT_NEAR(r, length(r1), tolerance);
    EXPECT_NEAR(end.run * end.sigma_m / radius_m, angle, tolerance);
    EXPECT_NEAR(std::atan2(end.rise, end.run), std::asin(dot(d1, r1) / length(r1)), tolerance);
    EXPECT_NEAR(end.bending_rad, std::acos(dot(d0, d1)), tolerance / std::sqrt(1 - dot(d0, d1) * dot(d0, d1)));
    EXPECT_NEAR(end.optical_path_m / unit_m, row.number("opl"), tolerance);
    ++traced;
    left += leaves;
  }
  EXPECT_EQ(skipped, 0);
  EXPECT_EQ(traced, 24);
  EXPECT_GT(left, 5);
}

TYPED_TEST(ClosedForm, ExponentialIndexTurnsEvenlyWithDistance) {
  // oracle: n = n0 exp(-h/H), flat: from n cos e = C follows de/dx = -1/H, so e = e0 - x/H, h = h0 + H ln(cos e/cos
  // e0),
  //         path = C H (tan e0 - tan e): the catenary of equal strength
  // tolerance: 1e-9 (float: 2e-6), relative to H, 1 rad and the path
  constexpr double scale_m = 8000;
  const auto refractivity = [](double h) {
    const double n = 1.5 * std::exp(-h / scale_m);
    return Dual(n - 1, -n / scale_m);
  };
  const IndexTable table = TestFixture::table_of(medium_of(refractivity, 20000, 0));
  for (double e0 : {0.9, 0.3, 0.05, 0.0, -0.1}) {
    const double x = e0 > 0 ? 1.5 * e0 * scale_m : 500, h0 = 3000, e = e0 - x / scale_m;
    const f64::RayEnd end = TestFixture::trace_one(table, launch(table, 0, h0, e0, x));
    ASSERT_EQ(end.outcome, f64::RAY_IN_FLIGHT);
    const double c = 1.5 * std::exp(-h0 / scale_m) * std::cos(e0), tolerance = TestFixture::relative;
    EXPECT_NEAR(std::atan2(end.rise, end.run), e, tolerance);
    EXPECT_NEAR(end.bending_rad, e0 - e, tolerance);
    EXPECT_NEAR(TestFixture::z_m(table, end), h0 + scale_m * std::log(std::cos(e) / std::cos(e0)), tolerance * scale_m);
    const double path = c * scale_m * (std::tan(e0) - std::tan(e));
    EXPECT_NEAR(end.optical_path_m, path, tolerance * path);
    EXPECT_EQ(end.turning_points, e0 > 0 ? 1 : 0);
  }
}

TYPED_TEST(ClosedForm, LinearIndexIsACatenary) {
  // oracle: n = n0 + k h, flat: from n cos e = C follows n = C cosh u with u = u0 + k x/C, sinh u = tan e,
  //         path = integral n^2/C dx = C^2/k [u/2 + sinh(2u)/4]
  // tolerance: 1e-9 (float: 4e-6), relative to the size of each; k h/n is up to 0.4, and float's n0 + k h loses no more
  constexpr double k = 5e-5;
  const auto refractivity = [](double h) { return Dual(0.2 + k * h, k); };
  const IndexTable table = TestFixture::table_of(medium_of(refractivity, 12000, 0));
  for (double e0 : {0.2, 0.0, -0.1, -0.3}) {
    const double h0 = 4000, x = 9000, n0 = 1.2 + k * h0, c = n0 * std::cos(e0);
    const double u0 = std::asinh(std::tan(e0)), u = u0 + k * x / c, n = c * std::cosh(u);
    const f64::RayEnd end = TestFixture::trace_one(table, launch(table, 0, h0, e0, x));
    ASSERT_EQ(end.outcome, f64::RAY_IN_FLIGHT) << e0;
    const double tolerance = 2 * TestFixture::relative;
    EXPECT_NEAR(TestFixture::z_m(table, end), (n - 1.2) / k, tolerance * 10000);
    EXPECT_NEAR(std::atan2(end.rise, end.run), std::atan(std::sinh(u)), tolerance);
    const double path = c * c / k * ((u - u0) / 2 + (std::sinh(2 * u) - std::sinh(2 * u0)) / 4);
    EXPECT_NEAR(end.optical_path_m, path, tolerance * path);
  }
}

TYPED_TEST(ClosedForm, ConstantIndexGivesStraightLines) {
  // oracle: straight lines, over a plane and around a sphere: r cos e constant, no bending, path = n times length
  // tolerance: 1e-9 (float: 2e-6) relative
  for (double radius_m : {0.0, 6371000.0}) {
    const IndexTable table = TestFixture::table_of(medium_of([](double) { return Dual(0.25); }, 50000, radius_m));
    for (double e0 : {0.0, 0.02, 0.4, 1.5, -0.02}) {
      const double x = e0 > 1 ? 2000 : 40000, h0 = 2000, tolerance = TestFixture::relative;
      const f64::RayEnd end = TestFixture::trace_one(table, launch(table, 0, h0, e0, x));
      double h1 = h0 + x * std::tan(e0), e1 = e0, distance = x / std::cos(e0);
      if (radius_m > 0) {
        const double angle = x / radius_m, r0 = radius_m + h0;
        e1 = e0 + angle;
        h1 = r0 * std::cos(e0) / std::cos(e1) - radius_m;
        distance = (h1 + radius_m) * std::sin(e1) - r0 * std::sin(e0);
      }
      if (h1 > 50000) continue;
      if (h1 < 0) {
        EXPECT_EQ(end.outcome, f64::RAY_GROUND);
        continue;
      }
      ASSERT_EQ(end.outcome, f64::RAY_IN_FLIGHT) << radius_m << " " << e0;
      const double h = f64::geometric_height_m(TestFixture::z_m(table, end), table.curvature_per_m);
      EXPECT_NEAR(h, h1, tolerance * distance) << e0;
      EXPECT_NEAR(std::atan2(end.rise, end.run), e1, tolerance) << e0;
      EXPECT_EQ(end.bending_rad, 0) << e0;
      EXPECT_NEAR(end.optical_path_m, 1.25 * distance, tolerance * 1.25 * distance) << e0;
    }
  }
}

TYPED_TEST(ClosedForm, UniformDuctCarriesAHorizontalRayAroundTheSphere) {
  // oracle: n proportional to 1/(R+h): the flattened index is constant, a horizontal ray stays at its height for ever
  // and
  //         turns by the central angle; others keep their elevation
  // tolerance: float: rounding of 1/R + gradient (1e-7 of 1/R) drifts, over 1000 km, by 0.5 x^2/R 1e-7 = 8 mm
  constexpr double radius_m = 6371000, n0 = 1.3;
  const auto refractivity = [](double h) {
    const double n = n0 * radius_m / (radius_m + h);
    return Dual(n - 1, -n / (radius_m + h));
  };
  const IndexTable table = TestFixture::table_of(medium_of(refractivity, 20000, radius_m));
  const double x = 1e6, tolerance = TypeParam::is_double ? 1e-9 : 2e-6;
  for (double e0 : {0.0, 0.005, -0.005}) {
    const f64::RayEnd end = TestFixture::trace_one(table, launch(table, 0, 8000, e0, x));
    ASSERT_EQ(end.outcome, f64::RAY_IN_FLIGHT);
    EXPECT_NEAR(std::atan2(end.rise, end.run), e0, tolerance);
    EXPECT_NEAR(TestFixture::z_m(table, end), f64::flattened_height_m(8000, 1 / radius_m) + x * std::tan(e0),
                TypeParam::is_double ? 1e-5 : 0.1);
    EXPECT_NEAR(end.bending_rad, x / radius_m, tolerance * x / radius_m);
  }
}

}  // namespace
}  // namespace greenray
