// A clear day and its twilight against published measurements, in lux and cd/m2.
#include <gtest/gtest.h>

#include <cmath>

#include "support_code/sky_light.hpp"

namespace greenray {
namespace {

using namespace testing_data;

const ClearDay &clear_day() {
  static const ClearDay day(40);
  return day;
}

void expect_within(double value, double published, double factor, const std::string &what) {
  EXPECT_LT(value, published * factor) << what;
  EXPECT_GT(value, published / factor) << what;
}

TEST(ClearSky, IlluminanceOfTheGroundByTheSunsAltitude) {
  // oracle: RCA Electro-Optics Handbook (1974), natural illuminance under clear sky, after Brown 1952
  // tolerance: a factor 1.35 by day and 1.6 in twilight: their air and haze are not told, and ours without night sky
  for (const auto &[sun_deg, lux] : std::vector<std::pair<double, double>>{
           {60, 1.02e5}, {30, 4.7e4}, {20, 2.73e4}, {10, 1.09e4}, {5, 4760}, {0, 732}, {-0.8, 453}})
    expect_within(clear_day().illuminance_lx(sun_deg), lux, 1.35, "Sun at " + std::to_string(sun_deg));
  for (const auto &[sun_deg, lux] : std::vector<std::pair<double, double>>{{-5, 10.8}, {-6, 3.40}, {-12, 8.31e-3}})
    expect_within(clear_day().illuminance_lx(sun_deg), lux, 1.6, "Sun at " + std::to_string(sun_deg));
}

TEST(ClearSky, LuminanceOfTheZenithByDay) {
  // oracle: Karayel, Navvab, Ne'eman & Selkowitz 1984 (Energy and Buildings 6, 283): clear zenith, kcd/m2,
  //         (1.376 T - 1.81) tan(altitude) + 0.38 with Linke's turbidity T, here 2.5 to 3 for this haze
  // tolerance: a factor 1.5 of the middle: days of one turbidity differ by about that
  for (double sun_deg : {10.0, 20.0, 30.0, 45.0}) {
    const double published = 1000 * ((1.376 * 2.75 - 1.81) * std::tan(to_rad(sun_deg)) + 0.38);
    expect_within(clear_day().zenith_cd_m2(sun_deg), published, 1.5, "Sun at " + std::to_string(sun_deg));
  }
}

TEST(ClearSky, LuminanceOfTheZenithInTwilight) {
  // oracle: Patat, Ugolnikov & Postylyakov 2006 (A&A 455, 385), V band at Paranal: 11.84 + 1.518 z - 0.057 z^2
  //         mag/arcsec^2, z = depression - 5 degrees; 0 mag/arcsec^2 is 1.08e5 cd/m2
  // tolerance: a factor 1.7: the site is at 2600 m, V is not the eye's band, and haze and volcanoes change twilights
  for (double depression_deg : {5.0, 6.0, 7.0, 8.0, 10.0}) {
    const double z = depression_deg - 5, magnitude = 11.84 + 1.518 * z - 0.057 * z * z;
    expect_within(clear_day().zenith_cd_m2(-depression_deg), 1.08e5 * std::pow(10, -0.4 * magnitude), 1.7,
                  "depression " + std::to_string(depression_deg));
  }
}

TEST(ClearSky, TheSunOutshinesTheSky) {
  // oracle: Beer & Lambert: 1.33e5 lx outside the air (Darula & Kittler 2005: 133334 lx) times exp(-tau/sin(altitude)),
  //         tau of air 0.098, ozone 0.027 and haze (3.912/40 km - 1.2e-5/m) 1200 m = 0.103 at 550 nm
  // tolerance: 5 %: tau varies over the eye's band and with the Sun's slant path
  for (double sun_deg : {60.0, 40.0, 20.0}) {
    const double expected = 133334 * std::exp(-0.228 / std::sin(to_rad(sun_deg)));
    EXPECT_NEAR(clear_day().direct_normal_lx(sun_deg) / expected, 1, 0.05) << sun_deg;
  }
}

TEST(ClearSky, OzoneKeepsTheTwilightZenithBlue) {
  // oracle: Hulburt 1953 (J. Opt. Soc. Am. 43, 113): without ozone the zenith at sunset would be yellowish grey, with
  // it
  //         it is blue: x, y of daylight near 6000 K without, well below with (Adams, Plass & Kattawar 1974)
  // tolerance: x + y above 0.60 is not blue, below 0.54 is bluer than 15000 K (0.264 + 0.270)
  const ClearDay without(40, 0);
  const auto chromaticity = [](const std::array<double, 3> &xyz) {
    return (xyz[0] + xyz[1]) / (xyz[0] + xyz[1] + xyz[2]);
  };
  EXPECT_GT(chromaticity(without.sky(-3, 90, 0, false)), 0.60);
  EXPECT_LT(chromaticity(clear_day().sky(-3, 90, 0)), 0.54);
  EXPECT_LT(chromaticity(clear_day().sky(-3, 90, 0, false)), chromaticity(without.sky(-3, 90, 0, false)) - 0.08);
}

TEST(ClearSky, TheHorizonUnderASettingSunIsRed) {
  // oracle: Rayleigh's law: long paths keep the long waves; with the Sun at -2 degrees the sky 3 degrees above the
  //         horizon beneath it is redder than at 15 degrees, that redder than the zenith (Minnaert 1954, section 189)
  // tolerance: the order itself
  const auto red = [](const std::array<double, 3> &xyz) { return xyz[0] / (xyz[0] + xyz[1] + xyz[2]); };
  const double low = red(clear_day().sky(-2, 3, 0)), middle = red(clear_day().sky(-2, 15, 0)),
               top = red(clear_day().sky(-2, 90, 0));
  EXPECT_GT(low, middle + 0.05);
  EXPECT_GT(middle, top + 0.02);
  EXPECT_GT(low, 0.40);
}

}  // namespace
}  // namespace greenray
