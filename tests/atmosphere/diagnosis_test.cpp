#include "atmosphere/diagnosis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "atmosphere/profile_file.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

// Written out again here, so that the expected values do not come from the code under test.
constexpr double radius_m = 6371000.0;
constexpr double hydrostatic_K_m = 9.80665 * 28.9644 / 8314.32;                     // g0 M0/R* = 0.034163
constexpr double standard_refractivity = 28.79e-5 * (1 + 5.67e-3 / (0.55 * 0.55));  // 0 C, 1 atm, 550 nm
double refractivity(double temperature_K, double pressure_Pa) {
  return standard_refractivity * (273.15 / temperature_K) * (pressure_Pa / 101325.0);
}

Profile profile(const std::string &toml) { return Profile(parse_profile("test.toml", toml)); }

/// Air with one straight gradient from 15 C at the ground.
Profile ramp(double gradient_K_m) {
  return profile(
      "base = \"none\"\n[[level]]\nheight_m = 0.0\ntemperature_K = 288.15\n[[level]]\nheight_m = 10.0\n"
      "temperature_K = " +
      std::to_string(288.15 + 10 * gradient_K_m) + "\n");
}

bool says(const Diagnosis &diagnosis, const std::string &word) {
  for (const std::string &sentence : diagnosis.expect)
    if (sentence.find(word) != std::string::npos) return true;
  return false;
}

double bisect(double a, double b, const std::function<double(double)> &f) {
  const bool positive = f(a) > 0;
  for (int i = 0; i < 80; ++i) ((f(0.5 * (a + b)) > 0) == positive ? a : b) = 0.5 * (a + b);
  return 0.5 * (a + b);
}

// oracle: in dry air light follows the Earth at dT/dh = T n/((n-1) R) - g M/R* = +0.1286 K/m at 15 C and 1 atm
// tolerance: half a unit of the last digit of 0.1286 is 3e-4 of k
TEST(Diagnosis, duct_begins_at_the_textbook_gradient) {
  EXPECT_NEAR(ray_curvature(ramp(0.1286), 0), 1.0, 4e-4);
  EXPECT_TRUE(diagnose(ramp(0.1280)).ducts.empty());
  const Diagnosis trapping = diagnose(ramp(0.1292));
  ASSERT_EQ(trapping.ducts.size(), 1u);
  EXPECT_EQ(trapping.ducts[0].bottom_m, 0.0);
}

// oracle: k = (R/n)(n-1)(g M/R* + dT/dh)/T of dry air, by hand: 0.1702 at the US Standard Atmosphere's foot
// tolerance: rounding
TEST(Diagnosis, standard_air_is_ordinary) {
  const Profile air = profile("");
  const Diagnosis found = diagnose(air, 2.0);
  const double n_1 = refractivity(288.15, 101325);
  EXPECT_NEAR(found.curvature_at_ground, radius_m * n_1 / (1 + n_1) * (hydrostatic_K_m - 0.0065) / 288.15, 1e-9);
  EXPECT_TRUE(found.ducts.empty());
  EXPECT_TRUE(found.superadiabatic.empty());
  EXPECT_TRUE(says(found, "Ordinary refraction"));
  // oracle: table 4 of the US Standard Atmosphere, warming from 20 to 47 geopotential km, 216.65 to 270.65 K
  // tolerance: edges lie on kinks, exact but for rounding; 1e-6 K
  ASSERT_EQ(found.inversions.size(), 1u);
  EXPECT_NEAR(found.inversions[0].bottom_m, 20000 / (1 - 20000 / 6356766.0), 1e-5);
  EXPECT_NEAR(found.inversions[0].top_m, 47000 / (1 - 47000 / 6356766.0), 1e-5);
  EXPECT_NEAR(found.inversions[0].rise_K, 54, 1e-6);
  EXPECT_NEAR(found.inversions[0].steepest_K_m, 2.8e-3, 0.05e-3);
}

// oracle: n-1 = N exp(-h/H): k(h) = (R + h) N exp(-h/H)/(H n), equal to 1 at the duct's top
// tolerance: rows every metre joined by straight lines: slopes are right to (1/H)^2/24 in a cell's middle, edges to a
// row
TEST(Diagnosis, exponential_refractivity_has_a_closed_form) {
  const double N = 4e-4, H = 1000;
  const auto n_1 = [&](double h) { return N * std::exp(-h / H); };
  std::string toml;
  for (int h = 0; h <= 3000; ++h) {
    char row[120];
    std::snprintf(row, sizeof row, "[[index_level]]\nheight_m = %d.0\nrefractivity = %.17g\n", h, n_1(h));
    toml += row;
  }
  const Profile medium = profile(toml);
  const auto k = [&](double h) { return (radius_m + h) * n_1(h) / (H * (1 + n_1(h))); };
  for (const double h : {0.5, 10.5, 700.5, 2000.5}) EXPECT_NEAR(ray_curvature(medium, h), k(h), 1e-6 * k(h)) << h;
  const Diagnosis found = diagnose(medium);
  ASSERT_EQ(found.ducts.size(), 1u);
  const double top = bisect(0, 3000, [&](double h) { return k(h) - 1; });
  EXPECT_EQ(found.ducts[0].bottom_m, 0);
  EXPECT_EQ(found.ducts[0].trapping_bottom_m, 0);
  EXPECT_NEAR(found.ducts[0].top_m, top, 1.0);
  const double drop = std::log1p(N) - std::log1p(n_1(top)) - std::log1p(top / radius_m);
  EXPECT_NEAR(found.ducts[0].index_drop, drop, 1e-6 * drop);
  EXPECT_NEAR(to_rad(found.ducts[0].widest_trapped_deg), std::sqrt(2 * drop), 1e-4 * std::sqrt(2 * drop));
  EXPECT_TRUE(found.inversions.empty());
}

// oracle: straight pieces of n: M rises at 1/R - 1e-8/n, falls at 5e-7/n - 1/R for 10 m, so the duct's foot lies
//         10 m x (fall/rise) below the trapping layer
// tolerance: second order in 100 m/R and in n-1: 2e-3 m
TEST(Diagnosis, elevated_duct_reaches_down_to_equal_modified_index) {
  const Profile medium = profile(
      "[[index_level]]\nheight_m = 0.0\nrefractivity = 3.0e-4\n[[index_level]]\nheight_m = 100.0\nrefractivity = "
      "2.99e-4\n"
      "[[index_level]]\nheight_m = 110.0\nrefractivity = 2.94e-4\n[[index_level]]\nheight_m = 400.0\n"
      "refractivity = 2.911e-4\n");
  const Diagnosis found = diagnose(medium);
  ASSERT_EQ(found.ducts.size(), 1u);
  const double n = 1.000298, curvature = 1 / (radius_m + 100);
  const double rise = curvature - 1e-8 / n, fall = 5e-7 / n - curvature;
  EXPECT_NEAR(found.ducts[0].trapping_bottom_m, 100, 1e-6);
  EXPECT_NEAR(found.ducts[0].top_m, 110, 1e-6);
  EXPECT_NEAR(found.ducts[0].bottom_m, 100 - 10 * fall / rise, 2e-3);
}

// oracle: Fermi step of 5 K at 20 m, 4 m diffuse, on the standard lapse: dT/dh = 0 and dT/dh = T n/((n-1)(R+h)) - g
// M/R*
//         solved here by bisection, with the pressure of air at its mean temperature
// tolerance: that pressure is right to 3e-5, which moves an edge by less than 1 mm
TEST(Diagnosis, fermi_inversion_traps_where_its_gradient_says) {
  const Profile air = profile("[[inversion]]\ndelta_T_K = 5.0\nheight_m = 20.0\ndiffuseness_m = 4.0\n");
  const auto step = [](double h) { return 1 / (1 + std::exp(-(h - 20) / 4)); };
  const auto temperature = [&](double h) { return 288.15 - 0.0065 * h - 5 + 5 * step(h); };
  const auto gradient = [&](double h) { return -0.0065 + 5.0 / 4 * step(h) * (1 - step(h)); };
  const auto beyond = [&](double h) {
    const double t = temperature(h), n_1 = refractivity(t, 101325 * std::exp(-hydrostatic_K_m * h / 284.5));
    return gradient(h) - (t * (1 + n_1) / (n_1 * (radius_m + h)) - hydrostatic_K_m);
  };
  const Diagnosis found = diagnose(air, 20);
  ASSERT_EQ(found.ducts.size(), 1u);
  EXPECT_NEAR(found.ducts[0].trapping_bottom_m, bisect(0, 20, beyond), 1e-3);
  EXPECT_NEAR(found.ducts[0].top_m, bisect(20, 60, beyond), 1e-3);
  ASSERT_GE(found.inversions.size(), 1u);
  EXPECT_NEAR(found.inversions[0].top_m, bisect(20, 80, gradient), 2e-3);
  EXPECT_EQ(found.inversions[0].bottom_m > 0, gradient(0) < 0);
  EXPECT_NEAR(found.inversions[0].steepest_K_m, 0.3125 - 0.0065, 1e-3);
  EXPECT_TRUE(says(found, "Superior mirage: the eye is in the duct"));
  EXPECT_TRUE(says(diagnose(air, 60), "Mock mirage"));
}

// oracle: the edges are those written into the profile
// tolerance: rounding of heights; for the Fermi step its gradient falls to the duct's threshold within 12 widths
TEST(Diagnosis, a_layer_of_ten_centimetres_is_not_missed) {
  const Profile rows = profile(
      "base = \"none\"\n[[level]]\nheight_m = 0.0\ntemperature_K = 288.0\n[[level]]\nheight_m = 8057.3\n"
      "temperature_K = 238.0\n[[level]]\nheight_m = 8057.4\ntemperature_K = 238.5\n[[level]]\nheight_m = 20000.0\n"
      "temperature_K = 216.0\n");
  const Diagnosis in_rows = diagnose(rows);
  ASSERT_EQ(in_rows.ducts.size(), 1u);
  EXPECT_NEAR(in_rows.ducts[0].trapping_bottom_m, 8057.3, 1e-6);
  EXPECT_NEAR(in_rows.ducts[0].top_m, 8057.4, 1e-6);

  const Diagnosis fermi =
      diagnose(profile("[[inversion]]\ndelta_T_K = 0.5\nheight_m = 3731.7\ndiffuseness_m = 0.01\n"));
  ASSERT_EQ(fermi.ducts.size(), 1u);
  EXPECT_NEAR(0.5 * (fermi.ducts[0].trapping_bottom_m + fermi.ducts[0].top_m), 3731.7, 1e-3);
  EXPECT_LT(fermi.ducts[0].top_m - fermi.ducts[0].trapping_bottom_m, 0.24);
}

// oracle: n rises while dT/dh < -g M/R*: 10 K e-folding in 0.1 m on -0.0065 K/m ends at 0.1 ln(100/(0.034163 -
// 0.0065));
//         the layer turns rays below sqrt(2 (n-1) dT/T)
// tolerance: the standard lapse changes by 1e-6 there: 1e-5 m
TEST(Diagnosis, hot_ground_bends_light_upwards) {
  const Diagnosis found = diagnose(profile("[[surface_layer]]\ndelta_T_K = 10.0\nscale_m = 0.1\n"), 1.5);
  ASSERT_EQ(found.superadiabatic.size(), 1u);
  EXPECT_EQ(found.superadiabatic[0].bottom_m, 0);
  EXPECT_NEAR(found.superadiabatic[0].top_m, 0.1 * std::log(100 / (hydrostatic_K_m - 0.0065)), 1e-4);
  EXPECT_NEAR(found.superadiabatic[0].index_rise, refractivity(288.15, 101325) * 10 / 298.15, 5e-8);
  EXPECT_TRUE(found.ducts.empty());
  EXPECT_TRUE(says(found, "Inferior mirage"));
  EXPECT_TRUE(says(found, "Sinking"));
}

// oracle: isothermal air, smoothed, has no inversion; a weak elevated inversion is the classic air of the mock mirage
// tolerance: words
TEST(Diagnosis, words_fit_the_air) {
  const Profile weak = profile("smooth_m = 2.0\n[[inversion]]\nfrom_m = 30.0\nto_m = 50.0\nrise_K = 0.8\n");
  const Diagnosis above = diagnose(weak, 60);
  EXPECT_TRUE(above.ducts.empty());
  EXPECT_TRUE(says(above, "Mock mirage"));
  EXPECT_FALSE(says(diagnose(weak, 10), "Mock mirage"));
  EXPECT_TRUE(says(diagnose(ramp(0.05), 2), "Looming"));
  EXPECT_EQ(diagnose(profile("smooth_m = 5.0\n")).inversions.size(), 1u);  // of the stratosphere only
}

// oracle: decimal digits
// tolerance: none
TEST(Diagnosis, plain_numbers_have_no_exponent) {
  EXPECT_EQ(plain_number(0.12857), "0.129");
  EXPECT_EQ(plain_number(12345678, 2), "12000000");
  EXPECT_EQ(plain_number(0), "0");
  EXPECT_EQ(plain_number(-2.5e-5), "-0.000025");
  EXPECT_EQ(plain_number(std::nan("")), "-");
}

}  // namespace
}  // namespace greenray
