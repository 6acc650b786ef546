// The section solver on host and device: the same text, every lane width, every batch; both precisions.
#include <gtest/gtest.h>

#include <cmath>

#include "atmosphere/profile_file.hpp"
#include "compute/section_tracer.hpp"
#include "render/section_rays.hpp"
#include "support/angle.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

/// A fan of rays at several azimuths through an inversion that moves: to space, to the ground, and on the way.
struct Fan {
  SectionTable table;
  std::vector<f64_section::RayStart> starts;
};

const Fan &fan() {
  static const Fan made = [] {
    const AirSection air(parse_profile("air.toml",
                                       "[[inversion]]\ndelta_T_K = { x_m = [-2e4, 1e5, 2e5], value = [9, 6, 0] }\n"
                                       "height_m = { x_m = [0, 5e4], value = [50, 80] }\ndiffuseness_m = 5\n"));
    Fan f{build_section_table(section_medium(air, false), {450, 550, 650}, {1e-3, 45}), {}};
    for (int i = 0; i < 301; ++i)
      f.starts.push_back(launch(f.table, static_cast<std::size_t>(i % 3), {3000.0 * (i % 7), 45},
                                to_rad(-0.75 + 0.005 * i), i % 4 ? 0.02 * i : 0, i % 5 == 4 ? 40000 : until_it_leaves));
    return f;
  }();
  return made;
}

TraceOptions options_for(Precision precision) {
  TraceOptions options;
  options.precision = precision;
  options.tolerance_rad = precision == Precision::double_ ? 1e-12 : 1e-9;
  return options;
}

TEST(SectionTwin, WholeRaysOnHostAndDevice) {
  // oracle: the host twin in double, the same text compiled as C++
  // tolerance: outcome and turning points equal; bending 1e-11 rad, height 1e-6 m (the device may contract a b + c)
  const HostSection host(fan().table);
  const auto device = SectionTracer(shared_device(), fan().table, options_for(Precision::double_)).trace(fan().starts);
  int kinds[f64::RAY_OUTCOMES] = {};
  for (std::size_t i = 0; i < device.size(); ++i) {
    const f64_section::RayEnd expected = host.trace(fan().starts[i], 1e-12);
    ++kinds[expected.outcome];
    ASSERT_EQ(device[i].outcome, expected.outcome) << i;
    EXPECT_EQ(device[i].turning_points, expected.turning_points) << i;
    EXPECT_EQ(device[i].column_number, expected.column_number) << i;
    EXPECT_NEAR(device[i].bending_rad, expected.bending_rad, 1e-11) << i;
    EXPECT_NEAR(device[i].sideways_rad, expected.sideways_rad, 1e-12) << i;
    EXPECT_NEAR(device[i].run * device[i].sigma_m, expected.run * expected.sigma_m, 1e-2) << i;
    if (expected.outcome == f64::RAY_IN_FLIGHT) {
      EXPECT_NEAR(device[i].above_m, expected.above_m, 1e-6) << i;
      EXPECT_NEAR(device[i].run * device[i].sigma_m, 40000, 1e-6) << i;
    }
  }
  EXPECT_GT(kinds[f64::RAY_SPACE], 100);
  EXPECT_GT(kinds[f64::RAY_GROUND], 50);
  EXPECT_GT(kinds[f64::RAY_IN_FLIGHT], 20);
}

void expect_same_bits(const std::vector<f64_section::RayEnd> &a, const std::vector<f64_section::RayEnd> &b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].outcome, b[i].outcome) << i;
    EXPECT_EQ(a[i].bending_rad, b[i].bending_rad) << i;
    EXPECT_EQ(a[i].sideways_rad, b[i].sideways_rad) << i;
    EXPECT_EQ(a[i].above_m, b[i].above_m) << i;
    EXPECT_EQ(a[i].steps, b[i].steps) << i;
    EXPECT_EQ(a[i].column[0], b[i].column[0]) << i;
  }
}

TEST(SectionTwin, BitsDoNotDependOnWhatIsTracedBesideThem) {
  // oracle: the same rays alone, in another order and with another local size
  // tolerance: exact
  for (Precision precision : {Precision::single_, Precision::double_}) {
    TraceOptions options = options_for(precision);
    const auto all = SectionTracer(shared_device(), fan().table, options).trace(fan().starts);
    options.local_size = 4;
    SectionTracer other(shared_device(), fan().table, options);
    expect_same_bits(other.trace(fan().starts), all);
    std::vector<f64_section::RayStart> reversed(fan().starts.rbegin(), fan().starts.rend());
    std::vector<f64_section::RayEnd> back = other.trace(reversed);
    expect_same_bits({back.rbegin(), back.rend()}, all);
  }
}

TEST(SectionTwin, EveryLaneWidth) {
  // oracle: one lane against four and eight
  // tolerance: double 1e-11 rad, float 2e-8 rad (0.004 arcsec) over the spreading of near rays, below 20 here
  for (Precision precision : {Precision::single_, Precision::double_}) {
    const TraceOptions options = options_for(precision);
    const auto one = SectionTracer(shared_device(1), fan().table, options).trace(fan().starts);
    for (int lanes : {4, 8}) {
      const auto more = SectionTracer(shared_device(lanes), fan().table, options).trace(fan().starts);
      for (std::size_t i = 0; i < one.size(); ++i) {
        ASSERT_EQ(one[i].outcome, more[i].outcome) << i << ", lanes " << lanes;
        EXPECT_NEAR(one[i].bending_rad, more[i].bending_rad, precision == Precision::double_ ? 1e-11 : 4e-7) << i;
      }
    }
  }
}

TEST(SectionTwin, CountsItsOutcomes) {
  // oracle: counts sum to the rays launched; drift of N^2 against the table stays at that of the steps
  // tolerance: exact; 1e-11 in double (300 steps of 1e-12), 2e-6 in float
  for (Precision precision : {Precision::single_, Precision::double_}) {
    SectionTracer tracer(shared_device(), fan().table, options_for(precision));
    (void)tracer.trace(fan().starts);
    std::uint64_t sum = 0;
    for (std::uint64_t count : tracer.stats().outcomes) sum += count;
    EXPECT_EQ(sum, fan().starts.size());
    EXPECT_LT(tracer.stats().bouguer_drift, precision == Precision::double_ ? 1e-11 : 2e-6);
  }
}

}  // namespace
}  // namespace greenray
