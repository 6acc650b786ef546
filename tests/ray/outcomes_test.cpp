// Every ray ends, with an outcome that is counted: odd observers, limits, numbers that are none.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "render/launch.hpp"
#include "support/angle.hpp"
#include "support_code/reference_table.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

using testing_data::reference_profile;

template <class Twin>
class Outcomes : public ::testing::Test {
 protected:
  static TraceOptions options() {
    TraceOptions o;
    o.precision = Twin::precision;
    o.storage = TableStorage::buffer;
    o.tolerance_rad = Twin::is_double ? 1e-12 : 1e-9;
    return o;
  }
  static IndexTable table_of(const char *profile, double eye_m = 0, bool flat = false) {
    return build_index_table(reference_profile(profile), {450, 650}, {flat, 1e-3, eye_m});
  }
  static f64::RayEnd trace_one(const IndexTable &table, double eye_m, double deg) {
    return RayTracer(shared_device(), table, options()).trace(std::vector{launch(table, 0, eye_m, to_rad(deg))})[0];
  }
  static constexpr double relative = Twin::is_double ? 1e-9 : 1e-6;
};
using Twins = ::testing::Types<Single, Double>;
TYPED_TEST_SUITE(Outcomes, Twins);

TYPED_TEST(Outcomes, SumToRaysLaunched) {
  // oracle: one outcome per ray; a duct with the eye inside sends rays to space, to the ground and into the trap
  // tolerance: exact
  const IndexTable table = TestFixture::table_of("duct_10K");
  std::vector<f64::RayStart> starts;
  for (int i = 0; i < 501; ++i)
    starts.push_back(launch(table, static_cast<std::size_t>(i % 2), 50, to_rad(-1 + 0.004 * i)));
  RayTracer tracer(shared_device(), table, TestFixture::options());
  const auto ends = tracer.trace(starts);
  const TraceStats &stats = tracer.stats();
  EXPECT_EQ(ends.size(), starts.size());
  EXPECT_EQ(stats.rays, starts.size());
  EXPECT_EQ(std::accumulate(stats.outcomes.begin(), stats.outcomes.end(), std::uint64_t{0}), starts.size());
  EXPECT_GT(stats.outcomes[f64::RAY_SPACE], 100u);
  EXPECT_GT(stats.outcomes[f64::RAY_GROUND], 100u);
  EXPECT_GT(stats.outcomes[f64::RAY_TRAPPED], 20u);
  EXPECT_EQ(stats.outcomes[f64::RAY_LIMIT] + stats.outcomes[f64::RAY_NOT_FINITE] + stats.outcomes[f64::RAY_RUNNING],
            0u);
  std::uint64_t steps = 0;
  for (const f64::RayEnd &end : ends) {
    steps += static_cast<std::uint64_t>(end.steps);
    if (end.outcome == f64::RAY_TRAPPED) {
      EXPECT_EQ(end.turning_points, 2);
    }
  }
  EXPECT_EQ(stats.steps, steps);
  // A second launch adds to the same counts.
  tracer.trace(starts);
  EXPECT_EQ(tracer.stats().rays, 2 * starts.size());
}

TYPED_TEST(Outcomes, StepLimitIsAnOutcome) {
  // oracle: max_steps counts accepted and rejected steps together; three are too few for any ray here
  // tolerance: exact
  const IndexTable table = TestFixture::table_of("us76");
  TraceOptions options = TestFixture::options();
  options.max_steps = 3;
  std::vector<f64::RayStart> starts;
  for (int i = 0; i < 20; ++i) starts.push_back(launch(table, 0, 2, to_rad(0.1 * i)));
  RayTracer tracer(shared_device(), table, options);
  for (const f64::RayEnd &end : tracer.trace(starts)) {
    EXPECT_EQ(end.outcome, f64::RAY_LIMIT);
    EXPECT_EQ(end.steps + end.rejected, 3);
    EXPECT_TRUE(std::isfinite(end.bending_rad));
  }
  EXPECT_EQ(tracer.stats().outcomes[f64::RAY_LIMIT], starts.size());
}

TYPED_TEST(Outcomes, NotANumberIsAnOutcomeAndStaysInItsLane) {
  // oracle: a NaN or an infinity in any field of the start ends that ray; its neighbours in the same bundle keep their
  // bits tolerance: exact
  const IndexTable table = TestFixture::table_of("us76");
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  std::vector<f64::RayStart> good;
  for (int i = 0; i < 16; ++i) good.push_back(launch(table, 0, 2, to_rad(0.3 * i)));
  std::vector<f64::RayStart> mixed = good;
  mixed[1].rise = nan;
  mixed[3].run = nan;
  mixed[6].above_m = nan;
  mixed[11].rise = infinity;
  mixed[12].above_m = infinity;
  const auto expected = RayTracer(shared_device(), table, TestFixture::options()).trace(good);
  RayTracer tracer(shared_device(), table, TestFixture::options());
  const auto ends = tracer.trace(mixed);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (i == 1 || i == 3 || i == 6 || i == 11 || i == 12) {
      EXPECT_EQ(ends[i].outcome, f64::RAY_NOT_FINITE) << i;
    } else {
      EXPECT_EQ(ends[i].outcome, f64::RAY_SPACE) << i;
      EXPECT_EQ(ends[i].bending_rad, expected[i].bending_rad) << i;
      EXPECT_EQ(ends[i].optical_path_m, expected[i].optical_path_m) << i;
    }
  }
  EXPECT_EQ(std::accumulate(tracer.stats().outcomes.begin(), tracer.stats().outcomes.end(), std::uint64_t{0}), 16u);
}

TYPED_TEST(Outcomes, NotANumberAsDistanceEndsToo) {
  // oracle: none needed: it must return, with an outcome that is no claim about the ray's way
  // tolerance: exact
  const IndexTable table = TestFixture::table_of("us76");
  std::vector<f64::RayStart> starts{launch(table, 0, 2, to_rad(1))};
  starts[0].sigma_end_m = std::numeric_limits<double>::quiet_NaN();
  const f64::RayEnd end = RayTracer(shared_device(), table, TestFixture::options()).trace(starts)[0];
  EXPECT_TRUE(end.outcome == f64::RAY_LIMIT || end.outcome == f64::RAY_NOT_FINITE) << end.outcome;
}

TYPED_TEST(Outcomes, StraightUpIsUnbentAndCrossesAllAir) {
  // oracle: symmetry: no bending; air above from the hydrostatic balance, integral of rho g = P0 - P(top), and the
  // column
  //         of Profile (its own quadrature); optical path = 120 km + integral of (n-1)
  // tolerance: column 1e-6 (float 5e-6) relative, path 0.01 mm (float: 20 roundings of 120 km, 0.15 m); the hydrostatic
  // column only to the 1.3 % by which g falls
  const Profile &profile = reference_profile("us76");
  const f64::RayEnd end = TestFixture::trace_one(TestFixture::table_of("us76"), 0, 90);
  EXPECT_EQ(end.outcome, f64::RAY_SPACE);
  EXPECT_NEAR(end.bending_rad, 0, 1e-12);
  EXPECT_NEAR(end.run * end.sigma_m, 0, 1e-2);
  const double column = profile.zenith_column_kg_m2(0);
  EXPECT_NEAR(end.column[0], column, (TypeParam::is_double ? 1e-6 : 5e-6) * column);
  EXPECT_GT(end.column[0], 101325 / 9.80665);
  EXPECT_LT(end.column[0], 1.013 * 101325 / 9.80665);
  double delay_m = 0;
  const int parts = 120000;
  for (int i = 0; i < parts; ++i) delay_m += profile.refractivity(i + 0.5, 450).value;
  EXPECT_NEAR(end.optical_path_m, 120000 + delay_m, TypeParam::is_double ? 1e-5 : 0.15);
}

TYPED_TEST(Outcomes, StraightDownHitsTheGround) {
  // oracle: symmetry; the same column as upwards from there
  // tolerance: as above
  const Profile &profile = reference_profile("us76");
  const f64::RayEnd end = TestFixture::trace_one(TestFixture::table_of("us76", 1000), 1000, -90);
  EXPECT_EQ(end.outcome, f64::RAY_GROUND);
  EXPECT_EQ(end.above_m, 0);
  EXPECT_EQ(end.cell, 0);
  EXPECT_NEAR(end.bending_rad, 0, 1e-12);
  const double column = profile.zenith_column_kg_m2(0) - profile.zenith_column_kg_m2(1000);
  EXPECT_NEAR(end.column[0], column, (TypeParam::is_double ? 1e-6 : 5e-6) * column);
}

TYPED_TEST(Outcomes, ObserverOnTheGround) {
  // oracle: standard air bends less than the Earth: a horizontal ray leaves, one below the horizon is stopped at once
  // tolerance: exact
  const IndexTable table = TestFixture::table_of("us76");
  const f64::RayEnd level = TestFixture::trace_one(table, 0, 0);
  EXPECT_EQ(level.outcome, f64::RAY_SPACE);
  EXPECT_EQ(level.turning_points, 0);
  EXPECT_EQ(level.min_z_m, 0);
  for (double deg : {-1e-6, -0.01, -1.0, -45.0, -90.0}) {
    const f64::RayEnd end = TestFixture::trace_one(table, 0, deg);
    EXPECT_EQ(end.outcome, f64::RAY_GROUND) << deg;
    EXPECT_NEAR(end.bending_rad, 0, 1e-12) << deg;
  }
}

TYPED_TEST(Outcomes, ObserversAboveTheAir) {
  // oracle: straight lines in vacuum, r cos e: from 200 and 400 km the air's top (120 km) lies acos(r_top/r) below the
  //         horizontal, the ground acos(r_ground n_ground/r); rays above the air are not bent, between both they graze
  //         it and leave (a known limb: refraction up to twice the horizon's), below they land
  // tolerance: outcomes exact; unbent rays exactly 0
  for (double eye_m : {200e3, 400e3}) {
    const IndexTable table = TestFixture::table_of("us76", eye_m);
    const double top_deg = -to_deg(std::acos((6371e3 + 120e3) / (6371e3 + eye_m)));
    const double ground_deg = -to_deg(std::acos(6371e3 * 1.000279 / (6371e3 + eye_m)));
    for (double deg : {90.0, 30.0, 0.0, -1.0, top_deg + 0.01}) {
      const f64::RayEnd end = TestFixture::trace_one(table, eye_m, deg);
      EXPECT_EQ(end.outcome, f64::RAY_SPACE) << eye_m << " " << deg;
      EXPECT_EQ(end.bending_rad, 0) << eye_m << " " << deg;
    }
    for (double deg : {top_deg - 0.01, 0.5 * (top_deg + ground_deg), ground_deg + 0.02}) {
      const f64::RayEnd end = TestFixture::trace_one(table, eye_m, deg);
      EXPECT_EQ(end.outcome, f64::RAY_SPACE) << eye_m << " " << deg;
      EXPECT_EQ(end.turning_points, 1) << eye_m << " " << deg;
      EXPECT_GE(end.bending_rad, 0);
      EXPECT_LT(to_arcsec(end.bending_rad), 2 * 1990.0);
    }
    for (double deg : {ground_deg - 0.02, -45.0, -90.0})
      EXPECT_EQ(TestFixture::trace_one(table, eye_m, deg).outcome, f64::RAY_GROUND) << eye_m << " " << deg;
  }
}

TYPED_TEST(Outcomes, GrazingRaysTouchTheGroundOrMiss) {
  // oracle: Bouguer: the ray that touches the ground from h leaves at cos e = n0 R/(n (R + h)); half a milli-degree
  //         (a thousandth for float at 10 km) to either side it lands or leaves
  // tolerance: outcomes exact; the lowest point above the ground to 1 % of the height by which it misses
  const Profile &profile = reference_profile("us76");
  for (double eye_m : {2.0, 1000.0, 10000.0}) {
    const IndexTable table = TestFixture::table_of("us76", eye_m);
    const double n0 = 1 + profile.refractivity(0, 450).value, n = 1 + profile.refractivity(eye_m, 450).value;
    const double graze_deg = -to_deg(std::acos(n0 * 6371e3 / (n * (6371e3 + eye_m))));
    EXPECT_EQ(TestFixture::trace_one(table, eye_m, graze_deg - 5e-4).outcome, f64::RAY_GROUND) << eye_m;
    const f64::RayEnd missed = TestFixture::trace_one(table, eye_m, graze_deg + 5e-4);
    EXPECT_EQ(missed.outcome, f64::RAY_SPACE) << eye_m;
    EXPECT_EQ(missed.turning_points, 1) << eye_m;
    EXPECT_GT(missed.min_z_m, 0);
    EXPECT_LT(missed.min_z_m, eye_m);
  }
}

TYPED_TEST(Outcomes, UniformDuctEndsAtTheStepLimit) {
  // oracle: n proportional to 1/(R+h) keeps a horizontal ray at its height for ever: no turning point, so only the step
  //         limit can end it; nothing hangs
  // tolerance: exact
  LayeredMedium medium;
  medium.refractivity = [](double h, double) {
    const double n = 1.3 * 6371e3 / (6371e3 + h);
    return Dual(n - 1, -n / (6371e3 + h));
  };
  medium.density_kg_m3 = [](double) { return 0.0; };
  medium.top_m = 1000;
  medium.radius_m = 6371e3;
  const IndexTable table = build_index_table(medium, {550, 650}, {});
  TraceOptions options = TestFixture::options();
  options.max_steps = 500;
  const auto end = RayTracer(shared_device(), table, options).trace(std::vector{launch(table, 0, 400, 0)})[0];
  if (TypeParam::is_double) {
    EXPECT_EQ(end.outcome, f64::RAY_LIMIT);
  }
  EXPECT_NE(end.outcome, f64::RAY_NOT_FINITE);
  EXPECT_LE(end.steps + end.rejected, 500);
}

TYPED_TEST(Outcomes, NothingToTraceIsNothing) {
  // oracle: no rays, no ends
  // tolerance: exact
  RayTracer tracer(shared_device(), TestFixture::table_of("us76"), TestFixture::options());
  EXPECT_TRUE(tracer.trace({}).empty());
  EXPECT_EQ(tracer.stats().rays, 0u);
}

}  // namespace
}  // namespace greenray
