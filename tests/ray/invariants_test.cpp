// What no ray may change: Bouguer's n r cos e, and the way back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "render/launch.hpp"
#include "support/angle.hpp"
#include "support_code/reference_table.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

using testing_data::reference_profile;

/// Eyes and profiles with ducts, mirages, kinks and plain air.
struct Air {
  const char *profile;
  double eye_m;
};
constexpr Air airs[] = {
    {"us76", 0},           {"us76", 1000},         {"thin_fermi", 9.6},     {"thin_fermi", 40},
    {"duct_10K", 45},      {"hot_road_thin", 1.5}, {"hot_road_thick", 0.3}, {"two_inversions", 22.5},
    {"linear_levels", 70}, {"cubic_levels", 100}};
constexpr double elevations_deg[] = {-0.9, -0.3, -0.1, -0.03, 0, 0.01, 0.05, 0.2, 1, 5, 30, 89};
constexpr double distances_m[] = {1000, 20000, 100000};

template <class Twin>
class Invariants : public ::testing::Test {
 protected:
  struct Run {
    const Air &air;
    const IndexTable &table;
    std::vector<f64::RayStart> starts;
    std::vector<f64::RayEnd> ends;
  };
  static TraceOptions options() {
    TraceOptions o;
    o.precision = Twin::precision;
    o.storage = TableStorage::buffer;
    o.with_columns = false;
    o.tolerance_rad = Twin::is_double ? 1e-13 : 1e-9;
    o.max_steps = 200000;
    return o;
  }
  static const IndexTable &table_of(const Air &air) {
    static std::map<std::string, IndexTable> known;
    const auto found = known.find(air.profile);
    if (found != known.end()) return found->second;
    IndexTableOptions wanted;
    wanted.error_arcsec = Twin::is_double ? 1e-5 : 1e-3;
    return known[air.profile] = build_index_table(reference_profile(air.profile), {550}, wanted);
  }
  template <class Check>
  static void for_each_air(Check check) {
    for (const Air &air : airs) {
      const IndexTable &table = table_of(air);
      std::vector<f64::RayStart> starts;
      for (double deg : elevations_deg)
        for (double x : distances_m) starts.push_back(launch(table, 0, air.eye_m, to_rad(deg), x));
      check(Run{air, table, starts, RayTracer(shared_device(), table, options()).trace(starts)});
    }
  }
  static double z_m(const IndexTable &table, int cell, double above_m) {
    return table.cell(0, static_cast<std::size_t>(cell)).bottom_m + above_m;
  }
};
using Twins = ::testing::Types<Single, Double>;
TYPED_TEST_SUITE(Invariants, Twins);

TYPED_TEST(Invariants, BouguerDriftIsSmall) {
  // oracle: Bouguer: n r cos e is constant in layers; the ray's own alarm against the table
  // tolerance: double 1e-12; float 2.5e-7 below 2 deg, the rounding of N (measured 5e-14 and 1e-7); steep rays in float
  // add
  //            a rounding of rise per step, measured 2.3e-6 over up to a hundred cells
  double low = 0, steep = 0;
  TestFixture::for_each_air([&](const auto &run) {
    for (const f64::RayEnd &end : run.ends) {
      double &worst = std::abs(end.rise) < 0.035 ? low : steep;
      worst = std::max(worst, end.bouguer_drift);
    }
  });
  EXPECT_LT(low, TypeParam::is_double ? 1e-12 : 2.5e-7);
  EXPECT_LT(steep, TypeParam::is_double ? 1e-12 : 5e-6);
}

TYPED_TEST(Invariants, BouguerHoldsAgainstTheProfileItself) {
  // oracle: Bouguer with n from Profile::refractivity in double at the height where the ray is: no table, no device
  // tolerance: as above
  double low = 0, steep = 0;
  int counted = 0;
  TestFixture::for_each_air([&](const auto &run) {
    const Profile &profile = reference_profile(run.air.profile);
    for (const f64::RayEnd &end : run.ends) {
      const double z = TestFixture::z_m(run.table, end.cell, end.above_m);
      const double h = std::clamp(f64::geometric_height_m(z, run.table.curvature_per_m), 0.0, 120000.0);
      const double expected = std::log1p(profile.refractivity(h, 550).value) + z * run.table.curvature_per_m;
      double &worst = std::abs(end.rise) < 0.035 ? low : steep;
      worst = std::max(worst, std::abs(std::log(std::hypot(end.run, end.rise)) - expected));
      ++counted;
    }
  });
  EXPECT_EQ(counted, static_cast<int>(std::size(airs) * std::size(elevations_deg) * std::size(distances_m)));
  EXPECT_LT(low, TypeParam::is_double ? 1e-12 : 2.5e-7);
  EXPECT_LT(steep, TypeParam::is_double ? 1e-12 : 5e-6);
}

TYPED_TEST(Invariants, RaysFindTheirWayBack) {
  // oracle: a ray turned around runs the same path: it comes back to the height and elevation it left with
  // tolerance: there and back over 100 km, double 3e-6 m and 1e-10 rad, float 0.2 m and 3e-6 rad; measured 7e-7 m and
  // 4e-11 rad, float 0.06 m
  //            and 1.4e-6 rad, both of steep rays through the hundred cells of a hot road
  double worst_m = 0, worst_rad = 0;
  int returned = 0;
  TestFixture::for_each_air([&](const auto &run) {
    std::vector<f64::RayStart> back, there;
    for (std::size_t i = 0; i < run.ends.size(); ++i) {
      const f64::RayEnd &end = run.ends[i];
      if (end.outcome != f64::RAY_IN_FLIGHT) continue;
      back.push_back({end.above_m, end.run, -end.rise, end.sigma_m, 0, end.cell});
      there.push_back(run.starts[i]);
    }
    const auto home = RayTracer(shared_device(), run.table, TestFixture::options()).trace(back);
    for (std::size_t i = 0; i < home.size(); ++i) {
      if (home[i].outcome == f64::RAY_GROUND && run.air.eye_m == 0) continue;  // home is the ground itself
      ASSERT_EQ(home[i].outcome, f64::RAY_IN_FLIGHT) << run.air.profile << " " << i;
      const double miss_m = std::abs(TestFixture::z_m(run.table, home[i].cell, home[i].above_m) -
                                     TestFixture::z_m(run.table, there[i].cell, there[i].above_m));
      const double miss_rad = std::abs(home[i].rise + there[i].rise);
      worst_m = std::max(worst_m, miss_m);
      worst_rad = std::max(worst_rad, miss_rad);
      ++returned;
    }
  });
  EXPECT_GT(returned, 150);
  EXPECT_LT(worst_m, TypeParam::is_double ? 3e-6 : 0.2);
  EXPECT_LT(worst_rad, TypeParam::is_double ? 1e-10 : 3e-6);
}

}  // namespace
}  // namespace greenray
