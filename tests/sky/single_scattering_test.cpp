// Singly scattered light against a brute-force integration, and the pieces that it is made of.
#include <gtest/gtest.h>

#include <cmath>

#include "support_code/reference_table.hpp"
#include "support_code/sky_light.hpp"

namespace greenray {
namespace {

using namespace testing_data;

ProfileSpec standard_air() {
  ProfileSpec spec;
  spec.index = IndexModel::born_wolf;
  return spec;
}

/// As in tests/oracle/sky.py.
std::unique_ptr<SkyField> oracle_field(double eye_m) {
  static const Profile air(standard_air());
  SkyFieldOptions options;
  options.eye_m = eye_m;
  return std::make_unique<SkyField>(
      layered_medium(air, false), LayerAbsorbers{},
      test_optics({2.126e-5, 9.43e-6, 4.77e-6}, {1.1e-7, 2.2e-6, 1.66e-6}, {6.5e-5, 5e-5, 4e-5}, 0.0148, 0.97, 0.76),
      options);
}

TEST(SingleScattering, AgreesWithBruteForce) {
  // oracle: tests/oracle/sky.py: every ray marched by Runge and Kutta through an air of its own making
  // tolerance: 1 %, asked for; 2 % where the light has grazed the ground on its way (Sun below 0), whose last ray the
  //            oracle itself finds to 0.025 degree / 2^18 but interpolates in between
  const ReferenceTable rows("sky_single_scattering.csv");
  const auto low = oracle_field(2), high = oracle_field(3000);
  EXPECT_EQ(rows.rows().size(), 16u);
  for (std::size_t i = 0; i < rows.rows().size(); ++i) {
    const auto number = [&](const char *name) { return rows.rows()[i].number(name); };
    const SkyField &field = number("eye_m") > 100 ? *high : *low;
    std::vector<float> light(field.optics().padded(), 0.0f);
    const double sun = number("sun_altitude_deg");
    add_scattered(field.line_of_sight(to_rad(number("elevation_deg"))), field.optics(), {&field.sunlight(), nullptr, 0},
                  to_rad(sun), std::cos(to_rad(number("azimuth_deg"))), light.data());
    const double tolerance = sun < 0 ? 0.02 : 0.01;
    EXPECT_NEAR(light[0] / number("radiance_450"), 1, tolerance) << "row " << i;
    EXPECT_NEAR(light[1] / number("radiance_550"), 1, tolerance) << "row " << i;
    EXPECT_NEAR(light[2] / number("radiance_650"), 1, tolerance) << "row " << i;
  }
}

TEST(SingleScattering, PhaseFunctionsSendAllLightSomewhere) {
  // oracle: their integral over the sphere is 1; that of cos times Henyey & Greenstein's is g
  // tolerance: Simpson's rule over 20000 panels of a smooth function, 1e-8
  constexpr int panels = 20000;
  double rayleigh = 0, haze = 0, forward = 0;
  const RayleighPhase phase = rayleigh_phase(rayleigh_anisotropy(450));
  for (int i = 0; i <= panels; ++i) {
    const double c = -1 + 2.0 * i / panels, weight = (i == 0 || i == panels ? 1 : i % 2 ? 4 : 2) * 2.0 / (3 * panels);
    rayleigh += 2 * pi * weight * (phase.even + phase.square * c * c);
    haze += 2 * pi * weight * aerosol_phase(c, 0.76);
    forward += 2 * pi * weight * c * aerosol_phase(c, 0.76);
  }
  EXPECT_NEAR(rayleigh, 1, 1e-8);
  EXPECT_NEAR(haze, 1, 1e-8);
  EXPECT_NEAR(forward, 0.76, 1e-8);
}

TEST(SingleScattering, DepolarisationIsThatOfAir) {
  // oracle: Young 1980 (Appl. Opt. 19, 3427): rho = 0.0279 for air in the visible; it grows towards the blue
  // tolerance: 3 %: Young has one value, Bates 1984 one for each wavelength
  const auto rho = [](double nm) {
    const double gamma = rayleigh_anisotropy(nm);
    return 2 * gamma / (1 + gamma);
  };
  EXPECT_NEAR(rho(550) / 0.0279, 1, 0.03);
  EXPECT_GT(rho(400), rho(550));
  EXPECT_GT(rho(550), rho(700));
}

TEST(SingleScattering, AirlightAndTransmittanceOfAPieceMakeTheWhole) {
  // oracle: light is additive: what lies beyond a place arrives through the piece before it. Beyond 60 km along a level
  //         path the whole less the piece, over the piece's transmittance, does not depend on where it was cut
  // tolerance: the cut falls within a shell, where light is taken as linear along the path: 0.2 %
  const auto field = oracle_field(10);
  const std::vector<double> irradiance{1, 1, 1};
  for (double elevation_deg : {0.2, 2.0, 20.0}) {
    const Airlight whole = field->airlight(to_rad(elevation_deg), 1e9, to_rad(12), 0.3, irradiance);
    double before = 0, passed = 1;
    for (double distance_m : {100.0, 1000.0, 5000.0, 20000.0, 80000.0}) {
      const Airlight piece = field->airlight(to_rad(elevation_deg), distance_m, to_rad(12), 0.3, irradiance);
      for (std::size_t w = 0; w < 3; ++w) {
        EXPECT_GT(piece.radiance[w], 0);
        EXPECT_LE(piece.radiance[w], whole.radiance[w] * 1.0001f);
        EXPECT_GE(piece.transmittance[w], whole.transmittance[w] * 0.9999f);
      }
      EXPECT_GT(piece.radiance[1], before);
      EXPECT_LT(piece.transmittance[1], passed);
      before = piece.radiance[1], passed = piece.transmittance[1];
    }
  }
}

TEST(SingleScattering, AirlightOfANearTargetFollowsItsPath) {
  // oracle: near the ground at e = 0 air and haze are uniform: T = exp(-(k_R rho + k_A) d), and the light grows in
  //         proportion to 1 - T (Koschmieder 1924)
  // tolerance: over 5 km at 10 m the path rises by 1.6 m: 0.1 % of haze; light changes by less than 0.5 %
  const auto field = oracle_field(10);
  const std::vector<double> irradiance{1, 1, 1};
  const double extinction[3] = {2.126e-5 * 1.2238 + 6.5e-5 * std::exp(-10 / 1200.0),
                                9.43e-6 * 1.2238 + 5e-5 * std::exp(-10 / 1200.0),
                                4.77e-6 * 1.2238 + 4e-5 * std::exp(-10 / 1200.0)};
  const Airlight near = field->airlight(0, 1000, to_rad(30), -0.5, irradiance);
  const Airlight far = field->airlight(0, 5000, to_rad(30), -0.5, irradiance);
  for (std::size_t w = 0; w < 3; ++w) {
    EXPECT_NEAR(near.transmittance[w] / std::exp(-1000 * extinction[w]), 1, 0.001);
    EXPECT_NEAR(far.transmittance[w] / std::exp(-5000 * extinction[w]), 1, 0.001);
    EXPECT_NEAR(far.radiance[w] / near.radiance[w] * (1 - near.transmittance[w]) / (1 - far.transmittance[w]), 1,
                0.005);
  }
}

}  // namespace
}  // namespace greenray
