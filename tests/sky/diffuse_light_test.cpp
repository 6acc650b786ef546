// Light scattered more than once: against photons, and by conservation of energy.
#include <gtest/gtest.h>

#include <cmath>

#include "sky/sea.hpp"
#include "support_code/reference_table.hpp"
#include "support_code/sky_light.hpp"

namespace greenray {
namespace {

using namespace testing_data;

/// An exponential air over a flat Earth, 8 km of scale height, that only scatters; n = 1.
LayeredMedium flat_air() {
  LayeredMedium medium;
  medium.refractivity = [](double, double) { return Dual{0, 0}; };
  medium.density_kg_m3 = [](double h) { return std::exp(-h / 8000); };
  medium.top_m = 100000;
  return medium;
}

SkyField flat_field(double depth, double albedo, double eye_m) {
  SkyFieldOptions options;
  options.ground_albedo = albedo;
  options.eye_m = eye_m;
  return SkyField(flat_air(), LayerAbsorbers{}, test_optics({depth / 8000}, {0}, {0}, 0, 1, 0), options);
}

/// Flux that leaves the air upward: radiance over the downward half of an eye's sphere at the top.
double flux_up(const SkyField &field, double sun_rad) {
  constexpr int steps = 48, turns = 8;
  double flux = 0;
  for (int i = 0; i < steps; ++i) {
    const double sine = (i + 0.5) / steps;
    const ScatterPath path = field.line_of_sight(-std::asin(sine));
    for (int k = 0; k < turns; ++k) {
      const double cos_azimuth = std::cos(pi * (k + 0.5) / turns);
      std::vector<float> light(field.optics().padded(), 0.0f);
      add_scattered(path, field.optics(), field.sources(), sun_rad, cos_azimuth, light.data());
      add_lambert_ground(path, field.sunlight(), field.sources(), sun_rad, cos_azimuth, light.data());
      flux += 2 * pi * sine * light[0] / (steps * turns);
    }
  }
  return flux;
}

TEST(DiffuseLight, AgreesWithPhotonsFollowedOneByOne) {
  // oracle: tests/oracle/sky_photons.py: 4 million photons through a flat Rayleigh air, all orders, full phase function
  // tolerance: fluxes 3 %, radiance 5 %: after the first order only mean and flux of the light are kept; the photons'
  // own
  //            noise is 0.2 %
  const ReferenceTable rows("sky_photons.csv");
  EXPECT_EQ(rows.rows().size(), 8u);
  for (std::size_t i = 0; i < rows.rows().size(); ++i) {
    const auto number = [&](const char *name) { return rows.rows()[i].number(name); };
    const double sun = std::asin(number("sine_of_sun_altitude"));
    const SkyField field = flat_field(number("depth"), number("albedo"), 0);
    std::vector<float> ground(field.optics().padded()), zenith(field.optics().padded(), 0.0f);
    field.diffuse().irradiance(sun, ground.data());
    add_scattered(field.line_of_sight(pi / 2), field.optics(), field.sources(), sun, 1, zenith.data());
    EXPECT_NEAR(ground[0] / number("diffuse_irradiance"), 1, 0.03) << "row " << i;
    EXPECT_NEAR(zenith[0] / number("zenith_radiance"), 1, 0.05) << "row " << i;
    const SkyField from_above = flat_field(number("depth"), number("albedo"), 100000);
    EXPECT_NEAR(flux_up(from_above, sun) / number("flux_up"), 1, 0.03) << "row " << i;
  }
}

TEST(DiffuseLight, NoLightIsLostOrMade) {
  // oracle: conservation: of what comes in, sin(altitude), all that the ground does not keep leaves again
  // tolerance: 1.5 %: quadrature over directions and orders beyond the fifth
  for (double albedo : {0.0, 0.5, 1.0})
    for (double sine : {0.2, 0.7}) {
      const SkyField field = flat_field(0.35, albedo, 0), from_above = flat_field(0.35, albedo, 100000);
      std::vector<float> sky(field.optics().padded()), direct(field.optics().padded());
      field.diffuse().irradiance(std::asin(sine), sky.data());
      field.sunlight().share(0, std::asin(sine), direct.data());
      const double kept = (1 - albedo) * (sky[0] + direct[0] * sine);
      EXPECT_NEAR((kept + flux_up(from_above, std::asin(sine))) / sine, 1, 0.015) << albedo << " " << sine;
    }
}

TEST(Sea, ReflectsWhatFresnelSays) {
  // oracle: Fresnel: ((n-1)/(n+1))^2 from above and 1 at grazing; under a uniform sky water of 1.34 reflects 6.7 %
  //         (Walsh 1926: 0.0663 for 4/3)
  // tolerance: closed form 1e-9; the hemispherical mean 0.002
  EXPECT_NEAR(fresnel_water(1), std::pow(0.34 / 2.34, 2), 1e-9);
  EXPECT_NEAR(fresnel_water(0), 1, 1e-9);
  constexpr int steps = 2000;
  double mean = 0;
  for (int i = 0; i < steps; ++i) {
    const double c = (i + 0.5) / steps;
    mean += 2 * c * fresnel_water(c) / steps;
  }
  EXPECT_NEAR(mean, 0.067, 0.002);
}

TEST(Sea, WavesDarkenTheHorizonAndStayWithinTheSky) {
  // oracle: Cox & Munk 1954: a rough sea at grazing view mirrors higher, darker sky at larger angles: darker than the
  //         sky above the horizon, darker the more wind; a smooth one nearly as bright as the sky at the horizon
  // tolerance: the order itself
  const ClearDay day(60);
  const SkyField &field = day.field();
  const double sun = to_rad(30), elevation = to_rad(-1.0);
  const auto sea = [&](double wind) {
    const Sea water(field, {sun}, wind);
    std::vector<float> light(field.optics().padded(), 0.0f);
    water.add(field.line_of_sight(elevation), {std::sin(sun), std::cos(sun), -1}, light.data());
    return day.tristimulus(light)[1];
  };
  const double horizon = day.sky(30, 0.5, 180)[1];
  EXPECT_GT(sea(0.0), sea(5.0));
  EXPECT_GT(sea(5.0), sea(15.0));
  EXPECT_LT(sea(0.0), horizon);
  EXPECT_GT(sea(15.0), 0.1 * horizon);
}

}  // namespace
}  // namespace greenray
