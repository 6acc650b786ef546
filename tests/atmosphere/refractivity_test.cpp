// n-1 of air by the four models, against what is published, and its derivative by height.
#include "atmosphere/refractivity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace greenray {
namespace {

constexpr IndexModel models[] = {IndexModel::born_wolf, IndexModel::iag1999, IndexModel::ciddor,
                                 IndexModel::peck_reeder};

/// Pure saturation vapour pressure over water [Pa] as Ciddor 1996 gives it; here in the test's own words.
double pure_saturation_Pa(double t_K) {
  return std::exp(1.2378847e-5 * t_K * t_K - 1.9121316e-2 * t_K + 33.93711047 - 6343.1645 / t_K);
}

AirState air_at(double celsius, double pressure_Pa, double relative_humidity) {
  const double t = celsius + 273.15;
  return {t, pressure_Pa, Dual(relative_humidity) * saturation_vapour_Pa(t, pressure_Pa)};
}

TEST(Ciddor, PublishedValuesAt633nm) {
  // oracle: Ciddor 1996, Appl. Opt. 35, 1566, tables 1 to 3 (rows with 450 ppm CO2): t C, P Pa, humidity (relative, or
  // Pa of
  //         vapour if above 1), (n-1) 1e8. Table 3, 40 C, 80 kPa prints 19996.5; its difference column shows 19896.5
  // tolerance: 0.4e-8: printed to 0.1e-8, and the paper's own rounding of inputs
  struct Row {
    double celsius, pressure_Pa, humidity, n_minus_1_e8;
  };
  const Row rows[] = {{20, 80e3, 0, 21458.0},           {20, 100e3, 0, 26824.4},    {20, 120e3, 0, 32191.6},
                      {10, 100e3, 0, 27774.7},          {30, 100e3, 0, 25937.2},    {19.173, 102993.0, 641, 27682.4},
                      {19.188, 102918.8, 706, 27658.7}, {20, 80e3, 0.75, 21394.0},  {20, 120e3, 0.75, 32127.8},
                      {40, 80e3, 0.75, 19896.5},        {40, 120e3, 0.75, 29941.8}, {50, 80e3, 1.0, 19058.4},
                      {50, 120e3, 1.0, 28792.4}};
  for (const Row &row : rows) {
    const double rh = row.humidity > 1 ? row.humidity / pure_saturation_Pa(row.celsius + 273.15) : row.humidity;
    const double got = refractivity(IndexModel::ciddor, 633.0, air_at(row.celsius, row.pressure_Pa, rh)).value;
    EXPECT_NEAR(1e8 * got, row.n_minus_1_e8, 0.4) << row.celsius << " C " << row.pressure_Pa << " Pa " << row.humidity;
  }
}

TEST(Ciddor, NistToolboxValues) {
  // oracle: NIST Engineering Metrology Toolbox, Ciddor's equation, 450 ppm CO2: n to 1e-9
  // tolerance: dry 1e-9; humid 1e-8, because its saturation pressure is IAPWS's and not Ciddor's
  struct Row {
    double celsius, pressure_kPa, humidity, nm, n;
  };
  const Row rows[] = {
      {20, 101.325, 0, 633, 1.000271800}, {20, 60, 0, 633, 1.000160924},       {20, 120, 0, 633, 1.000321916},
      {50, 100, 0, 633, 1.000243285},     {5, 100, 0, 633, 1.000282756},       {-40, 100, 0, 633, 1.000337580},
      {50, 120, 1.0, 633, 1.000287924},   {40, 120, 0.75, 633, 1.000299418},   {20, 100, 1.0, 633, 1.000267394},
      {40, 110, 1.0, 1700, 1.000270247},  {20, 101.325, 0, 1700, 1.000268479}, {40, 110, 1.0, 300, 1.000289000},
      {20, 101.325, 0, 300, 1.000286581}, {-40, 120, 0, 300, 1.000427233}};
  for (const Row &row : rows) {
    const double got =
        refractivity(IndexModel::ciddor, row.nm, air_at(row.celsius, 1e3 * row.pressure_kPa, row.humidity)).value;
    EXPECT_NEAR(1 + got, row.n, row.humidity > 0 ? 1e-8 : 1e-9) << row.celsius << " C " << row.nm << " nm";
  }
}

TEST(Iag1999, PhaseIndexGivesThePublishedGroupIndex) {
  // oracle: IAG resolution 3 (1999): group refractivity 287.6155 + 4.88660/l^2 + 0.06800/l^4 (1e-6, 0 C, 101325 Pa)
  // beside the
  //         phase refractivity; n_g = n - l dn/dl
  // tolerance: 1e-10: the resolution rounds its coefficients to 1e-5 (1e-11 at 1 um, 5e-11 at 0.4 um)
  for (double nm : {400.0, 550.0, 633.0, 850.0}) {
    const double um = nm * 1e-3, step = 0.01;
    const auto phase = [](double x) { return reference_refractivity(IndexModel::iag1999, x); };
    const double group = phase(nm) - nm * (phase(nm + step) - phase(nm - step)) / (2 * step);
    EXPECT_NEAR(group, 1e-6 * (287.6155 + 4.88660 / (um * um) + 0.06800 / std::pow(um, 4)), 1e-10) << nm;
  }
}

TEST(Iag1999, VapourTermAndReferenceAir) {
  // oracle: IAG resolution 3 (1999): N = 273.15/1013.25 p/T N_ph - 11.27 e/T (hPa, K, 1e-6), here for 20 C, 1000 hPa,
  // 15 hPa tolerance: 1e-12, rounding
  const double n_ph = 287.6155 + 1.62887 / 0.3025 + 0.01360 / (0.3025 * 0.3025);
  const double expected = 1e-6 * (273.15 / 1013.25 * 1000 / 293.15 * n_ph - 11.27 * 15 / 293.15);
  EXPECT_NEAR(refractivity(IndexModel::iag1999, 550, {293.15, 1e5, 1500.0}).value, expected, 1e-12);
  EXPECT_NEAR(refractivity(IndexModel::iag1999, 550, {273.15, 101325.0, 0.0}).value, 1e-6 * n_ph, 1e-15);
}

TEST(PeckReeder, LiesBesideCiddor) {
  // oracle: Ciddor 1996 section 2: his dry air is Peck & Reeder's, moved from 300 to 450 ppm CO2 (1 + 0.534e-6 x 150)
  // and
  //         to ITS-90 (a few 1e-5): they agree to 1e-8 over the visible
  // tolerance: 1.2e-8 (4e-5 of 2.8e-4)
  for (double nm : {360.0, 450.0, 550.0, 633.0, 780.0}) {
    const double at_300 = reference_refractivity(IndexModel::ciddor, nm) * (1 + 0.534e-6 * (300 - 450));
    EXPECT_NEAR(reference_refractivity(IndexModel::peck_reeder, nm), at_300, 1.2e-8) << nm;
  }
  // oracle: eq 2 by hand at 550 nm: 5791817/(238.0183 - 3.305785) + 167909/(57.362 - 3.305785) = 27782.41
  // tolerance: 0.01e-8
  EXPECT_NEAR(1e8 * refractivity(IndexModel::peck_reeder, 550, {288.15, 101325.0, 0.0}).value, 27782.41, 0.01);
}

TEST(BornWolf, IsCauchysFormula) {
  // oracle: G04 4.2 with B = 5.67e-3 um^2: 28.79e-5 (1 + 5.67e-3/0.3025) = 2.932963e-4 at 550 nm, 0 C
  // tolerance: 1e-9, the digits given
  EXPECT_NEAR(refractivity(IndexModel::born_wolf, 550, {273.15, 101325.0, 0.0}).value, 2.932963e-4, 1e-9);
}

TEST(AllModels, AgreeOnOrdinaryAir) {
  // oracle: each other: dry air at 15 C, 101325 Pa, 450 to 650 nm is known to 0.1 %
  // tolerance: 0.15 % (Born & Wolf's constants are good to 0.08 %)
  for (double nm : {450.0, 550.0, 650.0}) {
    const double ciddor = refractivity(IndexModel::ciddor, nm, air_at(15, 101325, 0)).value;
    for (IndexModel model : models)
      EXPECT_NEAR(refractivity(model, nm, air_at(15, 101325, 0)).value / ciddor, 1, 1.5e-3);
  }
}

TEST(AllModels, ShorterWavesBendMore) {
  // oracle: normal dispersion of air in 300..1000 nm
  // tolerance: exact
  for (IndexModel model : models)
    for (double nm = 300; nm < 1000; nm += 50)
      EXPECT_GT(reference_refractivity(model, nm), reference_refractivity(model, nm + 50));
}

TEST(AllModels, SlopeIsTheDerivativeByHeight) {
  // oracle: central differences along a made-up course of T, P and vapour with height
  // tolerance: 2e-9 of the slope: step 1 m against scales of 10 km gives 1e-9, rounding 3e-13/slope
  const auto state = [](double h, bool with_slopes) {
    const double t = 290 - 0.008 * h + 2e-7 * h * h, p = 1e5 * std::exp(-h / 8000), e = 1500 * std::exp(-h / 2000);
    AirState air;
    air.temperature_K = with_slopes ? Dual(t, -0.008 + 4e-7 * h) : Dual(t);
    air.pressure_Pa = with_slopes ? Dual(p, -p / 8000) : Dual(p);
    air.vapour_Pa = with_slopes ? Dual(e, -e / 2000) : Dual(e);
    return air;
  };
  for (IndexModel model : models)
    for (double h : {0.0, 700.0, 4000.0, 15000.0}) {
      const auto value = [&](double x) { return refractivity(model, 500, state(x, false)).value; };
      const double d1 = (value(h + 1) - value(h - 1)) / 2, d2 = (value(h + 2) - value(h - 2)) / 4;
      const double slope = (4 * d1 - d2) / 3;
      EXPECT_NEAR(refractivity(model, 500, state(h, true)).slope, slope, 2e-9 * std::abs(slope) + 1e-18) << h;
    }
}

TEST(SaturationVapour, PublishedPressures) {
  // oracle: steam tables: 611.2 Pa at 0 C, 2339.2 Pa at 20 C, 7384.9 Pa at 40 C; moist air enhances by about 1.004 at 1
  // atm tolerance: 0.1 % (Ciddor's formula is a fit), enhancement 1.0036 to 1.0049
  for (const auto &[celsius, pure_Pa] : {std::pair{0.0, 611.2}, {20.0, 2339.2}, {40.0, 7384.9}}) {
    const double t = celsius + 273.15;
    EXPECT_NEAR(pure_saturation_Pa(t), pure_Pa, 1e-3 * pure_Pa);
    const double enhanced = saturation_vapour_Pa(t, 101325.0).value / pure_saturation_Pa(t);
    EXPECT_GT(enhanced, 1.0036);
    EXPECT_LT(enhanced, 1.0049);
  }
}

}  // namespace
}  // namespace greenray
