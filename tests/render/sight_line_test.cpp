// Hidden heights, horizons and coefficients of refraction against closed forms.
#include "render/sight_line.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "atmosphere/profile_file.hpp"
#include "render/view_diagnosis.hpp"
#include "support/angle.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

/// n falls in a straight line from the ground to 3 km so that k is what is asked for at the ground.
AirSection air_of(double k) {
  ProfileSpec spec;
  const double slope = k * (1 + 280e-6) / spec.earth_radius_m;
  spec.index_levels = {{0, 280e-6, {}}, {3000, 280e-6 - 3000 * slope, {}}};
  return AirSection(spec);
}

struct Sight {
  double k, eye_m, distance_m;
};
class ConstantGradient : public ::testing::TestWithParam<Sight> {};

// oracle: n = n0 (R/r)^k: r^(1-k) cos e and (1 - k) x angle - e are constant (Bouguer), worked out in hidden_height_m;
// and the
//         surveyors' d^2 (1 - k)/2R beside it
// tolerance: a straight line in h and this power differ in k by h/R (2 - k): 1e-4 at 500 m, over the sagitta of the
// path;
//            the parabola leaves out d^4/R^3
TEST_P(ConstantGradient, hides_what_the_closed_form_says) {
  const auto [k, eye_m, distance_m] = GetParam();
  const AirSection air = air_of(k);
  NearRays rays(air, eye_m, 550, false, false, 0, shared_device());
  const SightLine line = sight_line(rays, distance_m, 600, {});
  const double radius = air.spec().earth_radius_m, wanted = hidden_height_m(radius, eye_m, distance_m, k);
  const double sagitta = distance_m * distance_m / (8 * radius);
  EXPECT_NEAR(line.hidden_m, wanted, 1e-3 + 2e-4 * sagitta * std::abs(k));
  const double beyond = std::max(0.0, distance_m - std::sqrt(2 * radius * eye_m / (1 - k)));
  EXPECT_NEAR(wanted, beyond * beyond * (1 - k) / (2 * radius), 0.01 + 2e-3 * wanted);
  EXPECT_NEAR(line.hidden_straight_m, hidden_height_m(radius, eye_m, distance_m, 0), 1e-12);
}

// oracle: de = (1 - k) x central angle along the ray, so its bending is k d/R and the coefficients are k themselves
// tolerance: k changes by h/R (2 - k) with height (1e-4), k_of_refraction by the slope of the path squared
TEST_P(ConstantGradient, has_its_k_on_every_line_of_sight) {
  const auto [k, eye_m, distance_m] = GetParam();
  const AirSection air = air_of(k);
  NearRays rays(air, eye_m, 550, false, false, 0, shared_device());
  const SightLine line = sight_line(rays, distance_m, 600, {});
  ASSERT_EQ(line.top.size(), 1U);
  EXPECT_TRUE(line.top[0].erect);
  EXPECT_NEAR(line.top[0].k_of_path, k, 5e-4);
  EXPECT_NEAR(line.top[0].k_of_refraction, k, 2e-3);
  EXPECT_NEAR(line.top[0].apparent_altitude_deg - line.geometric_altitude_deg, line.top[0].refraction_arcsec / 3600,
              1e-9);
}

INSTANTIATE_TEST_SUITE_P(Air, ConstantGradient,
                         ::testing::Values(Sight{0.13, 2, 20000}, Sight{0.17, 30, 60000}, Sight{0, 10, 40000},
                                           Sight{0.5, 5, 50000}, Sight{-0.6, 20, 30000}, Sight{0.13, 100, 5000}));

// oracle: geometry: without air the horizon from h lies at R acos(R/(R + h)) and hides R (1/cos - 1).  tolerance:
// rounding
TEST(SightLine, straight_light_is_geometry) {
  constexpr double radius = 6371000, eye = 17;
  const double horizon = radius * std::acos(radius / (radius + eye));
  EXPECT_NEAR(horizon_distance_m(radius, eye, 0), horizon, 1e-6);
  EXPECT_EQ(hidden_height_m(radius, eye, horizon * 0.999, 0), 0);
  EXPECT_NEAR(hidden_height_m(radius, eye, horizon + 25000, 0), radius * (1 / std::cos(25000 / radius) - 1), 1e-6);
  EXPECT_EQ(hidden_height_m(radius, eye, 1e6, 1.2), 0) << "light that curves more than the Earth hides nothing";
}

// oracle: n^2 = n0^2 - 2 a n0^2 h over a flat surface: the ray is h = h0 + x tan e - a x^2/(2 cos^2 e), exactly
// tolerance: n - 1 is a straight line, not n^2: a relative (a h)/1 of 1e-5 of the fall
TEST(NearRays, are_parabolas_where_n_squared_is_linear) {
  ProfileSpec spec;
  constexpr double a = 1e-7;  // 1/m
  spec.index_levels = {{0, 300e-6, {}}, {1000, 300e-6 - 1000 * a * (1 + 300e-6), {}}};
  const AirSection air(spec);
  NearRays rays(air, 100, 550, true, false, 0, shared_device());
  const std::vector<double> elevations{-0.01, 0, 0.004}, distances{1000, 5000, 8000};
  const std::vector<NearRay> found = rays.trace(elevations, distances);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double e = elevations[i / 3], x = distances[i % 3], fall = a * x * x / (2 * std::cos(e) * std::cos(e));
    if (found[i].outcome != f64::RAY_IN_FLIGHT) continue;
    EXPECT_NEAR(found[i].height_m, 100 + x * std::tan(e) - fall, 1e-4 + 3e-4 * fall);
  }
  EXPECT_EQ(found[7].outcome, f64::RAY_IN_FLIGHT);
}

// oracle: the horizon of standard air from 10 m: dip 0.0925 deg of other almanacs' 1.76' sqrt(h), and 3.83 km sqrt(h)
//         (Bowditch, tables 13 and 12: 1.76' and 2.07 nmi for a square root of metres); the target's coefficient near
//         0.17
// tolerance: 3 %, the almanac's k is 0.16 to 0.17
TEST(ViewDiagnosis, knows_the_horizon_of_standard_air) {
  ViewRequest request;
  request.height_m = 10;
  request.target = Target{30000, 50};
  const ViewDiagnosis view = diagnose_view(AirSection(ProfileSpec{}), request, shared_device());
  ASSERT_TRUE(view.horizon_deg && view.horizon_m && view.sight);
  EXPECT_NEAR(*view.horizon_deg, -1.76 / 60 * std::sqrt(10), 0.03 * 0.0928);
  EXPECT_NEAR(*view.horizon_m, 3830 * std::sqrt(10), 0.03 * 12000);
  EXPECT_NEAR(view.sight->top.at(0).k_of_path, 0.17, 0.01);
  EXPECT_EQ(view.fan.size(), 29U);
  EXPECT_FALSE(view.rows.empty());
}

}  // namespace
}  // namespace greenray
