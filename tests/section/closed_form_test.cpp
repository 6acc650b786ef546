// The adaptive solver where the answer is known: n^2 linear in height and in distance, mirrored air, rays sent back,
// ducts that end and ducts that do not.
#include <gtest/gtest.h>

#include <cmath>

#include "atmosphere/profile_file.hpp"
#include "compute/section_tracer.hpp"
#include "render/refraction.hpp"
#include "render/section_rays.hpp"
#include "support/angle.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

/// n^2 = 1.2 + up h + along x on a flat surface, 0 <= x <= reach_m, constant beyond; up to 50 m.
SectionMedium sloping(double up, double along, double reach_m) {
  SectionMedium medium;
  medium.at = [=](double x_m) {
    LayeredMedium stratum;
    stratum.refractivity = [=](double h, double) {
      const double n = std::sqrt(1.2 + up * h + along * x_m);
      return Dual(n - 1, up / (2 * n));
    };
    stratum.density_kg_m3 = [](double) { return 0.0; };
    stratum.top_m = 50;
    return stratum;
  };
  medium.points_m = {0, reach_m};
  medium.factor = [](double) { return 1.0; };
  medium.top_m = 50;
  return medium;
}

template <class Twin>
class SectionClosedForm : public ::testing::Test {};
using Twins = ::testing::Types<Single, Double>;
TYPED_TEST_SUITE(SectionClosedForm, Twins);

TraceOptions options_for(Precision precision) {
  TraceOptions options;
  options.precision = precision;
  options.tolerance_rad = precision == Precision::double_ ? 1e-13 : 1e-9;
  options.absorbers.earth_curvature_per_m = 0;
  return options;
}

TYPED_TEST(SectionClosedForm, ParabolasInALinearFieldOfTheSquareOfTheIndex) {
  // oracle: d2r/dsigma2 = grad(n^2)/2 is constant: x = q s + along s^2/4, h = h0 + p s + up s^2/4, and the direction
  // from
  //         (q + along s/2, p + up s/2); path = integral of n^2 ds
  // tolerance: double 1e-6 m and 2e-8 rad, the table's error (0.01 arcsec over 20 km); float 5e-4 m and 1e-5 rad of a
  //            bending of 0.2, 6e-4 m of path: n - 1 of 0.1 needs hundreds of cells, the paper's stepping thousands of
  //            steps, and each rounds
  const double up = 0.004, along = 0.003, reach_m = 60, eye_m = 5;
  const SectionTable table = build_section_table(sloping(up, along, reach_m), {550}, {0.01, eye_m});
  for (Integrator integrator : {Integrator::dormand_prince, Integrator::richardson}) {
    TraceOptions options = options_for(TypeParam::precision);
    options.integrator = integrator;
    options.max_steps = 1000000;
    if (integrator == Integrator::richardson && TypeParam::is_double) options.tolerance_rad = 1e-12;
    std::vector<f64_section::RayStart> starts;
    for (int i = 0; i < 37; ++i) starts.push_back(launch(table, 0, {0, eye_m}, to_rad(1 + i), 0, 40.0));
    const auto ends = SectionTracer(shared_device(), table, options).trace(starts);
    const double n2 = 1.2 + up * eye_m;
    int in_flight = 0;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const double e = to_rad(1 + static_cast<double>(i)), q = std::sqrt(n2) * std::cos(e),
                   p = std::sqrt(n2) * std::sin(e);
      const double s = 2 * 40.0 / (q + std::sqrt(q * q + along * 40.0));
      const double h = eye_m + p * s + up * s * s / 4;
      if (h >= 50) continue;
      ++in_flight;
      ASSERT_EQ(ends[i].outcome, f64_section::RAY_IN_FLIGHT) << i;
      const f64::RayEnd end = plain(ends[i], table);
      const double q1 = q + along * s / 2, p1 = p + up * s / 2;
      EXPECT_NEAR(end.above_m, h, TypeParam::is_double ? 1e-6 : 5e-4) << i;
      EXPECT_NEAR(std::atan2(end.rise, end.run), std::atan2(p1, q1), TypeParam::is_double ? 2e-8 : 1e-5) << i;
      EXPECT_NEAR(end.bending_rad, e - std::atan2(p1, q1), TypeParam::is_double ? 2e-8 : 1e-5) << i;
      const double path = n2 * s + (p * up + q * along) * s * s / 2 + (up * up + along * along) * s * s * s / 12;
      EXPECT_NEAR(end.optical_path_m, path, TypeParam::is_double ? 1e-6 : 6e-4) << i;
      EXPECT_LT(end.bouguer_drift, TypeParam::is_double ? 1e-8 : 2e-5) << i;
    }
    EXPECT_GT(in_flight, 25);
  }
}

std::string inversion(const std::string &delta, const std::string &height) {
  return "[[inversion]]\ndelta_T_K = " + delta + "\nheight_m = " + height + "\ndiffuseness_m = 6\n";
}
AirSection air(const std::string &text) { return AirSection(parse_profile("air.toml", text)); }

RefractionTable seen(const AirSection &air, Precision precision, double azimuth_deg, double eye_m = 45) {
  RefractionRequest request;
  request.height_m = eye_m;
  request.altitudes_deg = {-0.3, -0.12, -0.05, 0, 0.03, 0.1, 0.3, 1, 20, 90};
  request.wavelengths_nm = {550};
  request.precision = precision;
  request.method = RayMethod::dormand_prince;
  request.section = true;
  request.azimuth_rad = to_rad(azimuth_deg);
  request.tolerance_arcsec = precision == Precision::double_ ? 1e-5 : 0.02;
  return refraction_table(air, request, shared_device());
}

TYPED_TEST(SectionClosedForm, LookingBackIsLookingThroughMirroredAir) {
  // oracle: symmetry: x -> -x
  // tolerance: each solution's own: double 2e-5 arcsec, float 0.02, over max(1, |dR/da|), which is below 40 here
  const AirSection ahead =
      air(inversion("{ x_m = [-5e3, 4e4, 9e4], value = [2, 9, 1] }", "{ x_m = [0, 5e4], value = [50, 70] }"));
  const AirSection behind =
      air(inversion("{ x_m = [-9e4, -4e4, 5e3], value = [1, 9, 2] }", "{ x_m = [-5e4, 0], value = [70, 50] }"));
  const RefractionTable a = seen(ahead, TypeParam::precision, 0), b = seen(behind, TypeParam::precision, 180);
  for (std::size_t i = 0; i < a.rows.size(); ++i) {
    ASSERT_EQ(a.rows[i].outcome, b.rows[i].outcome) << i;
    EXPECT_EQ(a.rows[i].turning_points, b.rows[i].turning_points) << i;
    if (a.rows[i].refraction_arcsec) {
      EXPECT_NEAR(*a.rows[i].refraction_arcsec, *b.rows[i].refraction_arcsec, 40 * (TypeParam::is_double ? 2e-5 : 0.02))
          << i;
    }
  }
}

TYPED_TEST(SectionClosedForm, DuctsHoldTheirRaysOnlyWhereTheyDoNotEnd) {
  // oracle: a duct that begins at 20 km and never ends keeps the ray that it catches (trapped); the same duct cut off
  // at
  //         200 km lets it go (space or ground), and so does the proof wait for the place beyond which nothing varies
  // tolerance: exact
  const std::string height = "50";
  const AirSection endless = air(inversion("{ x_m = [2e4, 6e4], value = [4, 10] }", height));
  const AirSection ending = air(inversion("{ x_m = [2e4, 6e4, 2e5, 2.2e5], value = [4, 10, 10, 0] }", height));
  const RefractionTable held = seen(endless, TypeParam::precision, 0), freed = seen(ending, TypeParam::precision, 0);
  int trapped = 0;
  for (std::size_t i = 0; i < held.rows.size(); ++i) {
    EXPECT_NE(freed.rows[i].outcome, f64::RAY_TRAPPED) << i;
    EXPECT_NE(freed.rows[i].outcome, f64::RAY_LIMIT) << i;
    if (held.rows[i].outcome != f64::RAY_TRAPPED) continue;
    ++trapped;
    EXPECT_GE(held.rows[i].turning_points, 2);
    EXPECT_FALSE(held.rows[i].refraction_arcsec);
    EXPECT_GT(freed.rows[i].turning_points, 4) << "it went through the duct to its end";
  }
  EXPECT_GE(trapped, 1);
}

TYPED_TEST(SectionClosedForm, RaysThatNeverLeaveEndAtTheLimit) {
  // oracle: an eye that looks almost straight across the path of an endless duct stays in varying air: neither held nor
  //         free within the steps allowed
  // tolerance: exact
  const AirSection duct = air(inversion("{ x_m = [-1e5, 1e5], value = [9, 11] }", "50"));
  const SectionTable table = build_section_table(section_medium(duct, false), {550}, {1e-3, 45});
  TraceOptions options = options_for(TypeParam::precision);
  options.max_steps = 2000;
  const std::vector<f64_section::RayStart> starts{launch(table, 0, {0, 45}, 0, to_rad(89.9)),
                                                  launch(table, 0, {0, 45}, 0, pi / 2)};
  const auto ends = SectionTracer(shared_device(), table, options).trace(starts);
  EXPECT_EQ(ends[0].outcome, f64_section::RAY_LIMIT);
  EXPECT_GT(ends[0].turning_points, 4);
}

TYPED_TEST(SectionClosedForm, RaysReturnWhereTheyCameFrom) {
  // oracle: reversibility: from a ray's end, sent back, to the eye's height and direction
  // tolerance: double 1e-5 m and 1e-9 rad, float 5 cm and 2e-6 rad, after 80 km and back through the layer
  const AirSection varying =
      air(inversion("{ x_m = [0, 4e4, 9e4], value = [2, 7, 1] }", "{ x_m = [0, 5e4], value = [50, 70] }"));
  const SectionTable table = build_section_table(section_medium(varying, false), {550}, {1e-6, 45});
  SectionTracer tracer(shared_device(), table, options_for(TypeParam::precision));
  for (double elevation_deg : {0.05, 0.2}) {
    const double far_m = 80000;
    const auto there = tracer.trace(std::vector{launch(table, 0, {0, 45}, to_rad(elevation_deg), 0, far_m)}).front();
    ASSERT_EQ(there.outcome, f64_section::RAY_IN_FLIGHT);
    const f64::RayEnd end = plain(there, table);
    const double height_m = f64::geometric_height_m(end.above_m, table.curvature_per_m);
    const auto back =
        tracer.trace(std::vector{launch(table, 0, {far_m, height_m}, -std::atan2(end.rise, end.run), pi, far_m)})
            .front();
    const f64::RayEnd home = plain(back, table);
    EXPECT_NEAR(f64::geometric_height_m(home.above_m, table.curvature_per_m), 45, TypeParam::is_double ? 1e-5 : 0.05);
    EXPECT_NEAR(std::atan2(home.rise, home.run), -to_rad(elevation_deg), TypeParam::is_double ? 1e-9 : 2e-6);
  }
}

}  // namespace
}  // namespace greenray
