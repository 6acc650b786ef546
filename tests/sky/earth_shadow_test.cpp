// The Moon, and the light in the Earth's shadow.
#include <gtest/gtest.h>

#include <cmath>

#include "sky/earth_shadow.hpp"
#include "sky/moon.hpp"
#include "support_code/reference_table.hpp"
#include "support_code/sky_light.hpp"

namespace greenray {
namespace {

using namespace testing_data;

/// Shells from the ground up, fine everywhere: rays that graze each of them are wanted.
AirShells limb(const Profile &air) {
  std::vector<double> heights;
  for (double h = 0; h < 30000; h += 250) heights.push_back(h);
  for (double h = 30000; h <= 120000; h += 1000) heights.push_back(h);
  return AirShells(layered_medium(air, false), 550, LayerAbsorbers{}, heights);
}

const SkyOptics &clear_limb() {  // 450, 550, 650 nm: air and 300 DU of ozone
  static const SkyOptics optics =
      test_optics({2.126e-5, 9.43e-6, 4.77e-6}, {1.1e-7, 2.2e-6, 1.66e-6}, {0, 0, 0}, 0.0148, 1, 0);
  return optics;
}

/// The air of tests/oracle/sky.py.
Profile oracle_air() {
  ProfileSpec spec;
  spec.index = IndexModel::born_wolf;
  return Profile(spec);
}

const EarthShadow &shadow() {
  static const EarthShadow known(limb(oracle_air()), clear_limb(), from_arcsec(959.63));
  return known;
}

TEST(EarthShadow, GrazingRaysAreBentTwiceTheHorizontalRefraction) {
  // oracle: reference/refraction_standard.csv's 1982" at the horizon of US76 at 550 nm: twice that, 66.1'; in an
  //         exponential air of scale height H the bending of a grazing ray is (n-1) sqrt(2 pi R/H) (Fjeldbo & Eshleman
  //         1968), which falls by a factor e within H
  // tolerance: 0.1 % of the first; 6 % of the closed form at 15 and 18 km, where US76 is isothermal
  const auto &grazes = shadow().grazes();
  EXPECT_NEAR(to_deg(grazes.front().bending_rad) * 60 / (2 * 1982.156 / 60), 1, 0.001);
  const Profile air = oracle_air();
  for (const EarthShadow::Graze &g : grazes) {
    if (g.height_m != 15000 && g.height_m != 18000) continue;
    const double scale_m = 287.053 * 216.65 / 9.76;
    const double expected =
        air.refractivity(g.height_m, 550).value * std::sqrt(2 * pi * (6371000 + g.height_m) / scale_m);
    EXPECT_NEAR(g.bending_rad / expected, 1, 0.06) << g.height_m;
  }
}

TEST(EarthShadow, LightCrossesTheAxisShortOfTheMoon) {
  // oracle: R/bending: rays that graze the ground meet the axis at 6371 km/66.1' = 331000 km (von Oppolzer's and Link's
  //         "umbra is lit from within" needs this below 384400 km); bent half as much they do not reach it
  // tolerance: 1 %
  const auto &grazes = shadow().grazes();
  EXPECT_NEAR(6371e3 / grazes.front().bending_rad / 331e6, 1, 0.01);
  for (const EarthShadow::Graze &g : grazes)
    if (g.height_m > 10000) {
      EXPECT_GT((6371e3 + g.height_m) / g.bending_rad, 384.4e6);
    }
}

TEST(EarthShadow, AllLightThatEntersTheShadowIsThere) {
  // oracle: conservation: without extinction, what is laid down within a wide circle is what passes the limb: the disk
  //         of the Earth as its air shows it, n R, is missing and no more
  // tolerance: 0.2 % of the Earth's disk: rows 100 km apart
  const SkyOptics none = test_optics({0}, {0}, {0}, 0, 1, 0);
  const EarthShadow lossless(limb(Profile(ProfileSpec{})), none, from_arcsec(959.63));
  double missing = 0;
  for (std::size_t i = 0; i < lossless.rows(); ++i)
    missing += 2 * pi * static_cast<double>(i) * 100e3 * 100e3 * (1.0 - static_cast<double>(lossless.row(i)[0]));
  const double spread = 1 + 384.4e6 / 149.6e9;
  EXPECT_NEAR(missing / (pi * std::pow(6371e3 * 1.000278 * spread, 2)), 1, 0.002);
}

TEST(EarthShadow, AgreesWithRaysSentBackFromTheMoon) {
  // oracle: tests/oracle/eclipse.py: radiance along rays marched through US76, integrated over the directions in which
  // a
  //         place in the shadow sees the Sun
  // tolerance: 2 % where red and green light is 1e-5 or more, 6 % in the deep blue, which has passed 10 depths of air
  // in
  //            shells of 250 m; 1e-3 of full light at the edge, where rows 100 km apart hold a slope of 1e-4 a km
  const ReferenceTable rows("earth_shadow.csv");
  EXPECT_EQ(rows.rows().size(), 15u);
  std::vector<float> share(shadow().padded());
  for (const ReferenceRow &row : rows.rows()) {
    const double km = row.number("from_axis_km");
    shadow().share(1e3 * km, share.data());
    for (const auto &[w, name, tolerance] :
         {std::tuple{0, "share_450", 0.06}, std::tuple{1, "share_550", 0.02}, std::tuple{2, "share_650", 0.02}}) {
      const double expected = row.number(name);
      EXPECT_NEAR(share[static_cast<std::size_t>(w)], expected, std::max(tolerance * expected, km > 4500 ? 1e-3 : 0.0))
          << km << " km, " << name;
    }
  }
}

TEST(EarthShadow, TotalEclipsesAreAsDarkAsMeasured) {
  // oracle: Vital's analysis of the eclipse of 28 September 2015, moderately dark: 50000 times fainter than full. Air
  //         without clouds and haze at the limb is brighter. Mean of places 500 to 3500 km from the axis
  // tolerance: a factor 10
  std::vector<float> share(shadow().padded());
  double mean = 0;
  for (double x = 500e3; x <= 3500e3; x += 500e3) {
    shadow().share(x, share.data());
    mean += share[1] / 7;
  }
  EXPECT_GT(mean, 2e-5);
  EXPECT_LT(mean, 2e-4);
}

TEST(EarthShadow, CopperInsideWhiteOutside) {
  // oracle: Danjon's scale: the umbra of a bright eclipse is copper red. Beyond shadow and disk all light is there;
  // ozone
  //         takes the yellow before the blue (Chappuis), so that near the edge of the umbra 550 nm is the faintest
  // tolerance: the order; outside 1e-3
  std::vector<float> share(shadow().padded());
  shadow().share(1500e3, share.data());
  EXPECT_GT(share[2], 10 * share[0]);
  EXPECT_GT(share[2], 5 * share[1]);
  shadow().share(4600e3, share.data());
  EXPECT_GT(share[0], 1.1f * share[1]);
  EXPECT_GT(share[2], 1.1f * share[1]);
  shadow().share(8400e3, share.data());
  EXPECT_NEAR(share[1], 1, 1e-3);
}

TEST(Moon, FullAndHalfMoonsIlluminateAsMeasured) {
  // oracle: Allen 1973: full Moon -12.73 mag, and 2.54e-6 lx at magnitude 0: 0.314 lx; half Moon at 90 degrees 2.60 mag
  //         fainter; Lommel & Seeliger's own phase function at 90 degrees, 1 - ln(cot 22.5) /sqrt(2) = 0.3768
  // tolerance: 10 % for the full Moon (its albedo); the closed form 1e-9
  const CsvTable observer = CsvTable::embedded("host/data/cie1931_2deg_xyz_5nm.csv");
  const CsvTable sun = CsvTable::embedded("host/data/solar_extraterrestrial_5nm.csv");
  double luminance = 0;
  for (double nm = 390; nm <= 720; nm += 5)
    luminance += 683 * 5 * observer.interpolate("nm", "y", nm) * sun.interpolate("nm", "E490", nm) * lunar_albedo(nm) /
                 pi * lunar_phase_factor(0);
  const double disk_sr = pi * std::pow(to_rad(31.09 / 120), 2);
  EXPECT_NEAR(luminance * disk_sr / (2.54e-6 * std::pow(10, 0.4 * 12.73)), 1, 0.1);
  EXPECT_GT(luminance, 2500);
  EXPECT_LT(luminance, 6000);
  EXPECT_NEAR(lommel_seeliger_phase(pi / 2), 1 - std::log(1 / std::tan(pi / 8)) / std::sqrt(2), 1e-9);
  const double half = lunar_phase_factor(pi / 2) * lommel_seeliger_phase(pi / 2);
  EXPECT_NEAR(-2.5 * std::log10(half), 0.026 * 90 + 4e-9 * std::pow(90, 4), 1e-9);
}

}  // namespace
}  // namespace greenray
