// The Novaya Zemlya effect, the planner's choice, and pictures through air that varies.
#include <gtest/gtest.h>

#include <cmath>

#include "atmosphere/profile_file.hpp"
#include "render/refraction.hpp"
#include "render/renderer.hpp"
#include "render/solver_choice.hpp"
#include "render/transfer_curve.hpp"
#include "scene/scene_file.hpp"
#include "support/angle.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

RefractionTable look(const ProfileSpec &spec, std::vector<double> altitudes_deg) {
  RefractionRequest request;
  request.height_m = 14;
  request.altitudes_deg = std::move(altitudes_deg);
  request.wavelengths_nm = {550};
  request.precision = Precision::single_;
  request.method = RayMethod::dormand_prince;
  request.section = true;
  request.tolerance_arcsec = 0.1;
  return refraction_table(AirSection(spec), request, shared_device());
}

TEST(NovayaZemlya, ShowsTheSunFourToFiveDegreesBelowTheHorizon) {
  // oracle: geometry: light that follows the Earth for 400 to 450 km and leaves level there comes from 3.6 to 4.1
  //         degrees below, plus the 0.4 to 0.6 degrees of ordinary refraction in cold air; reports of 1597: 4 to 5
  //         degrees
  // tolerance: as the words say
  const ProfileSpec spec = load_profile("novaya-zemlya", "", {});
  std::vector<double> altitudes;
  for (double a = -0.1; a < 0.11; a += 0.005) altitudes.push_back(a);
  int through = 0;
  for (const RefractionRow &row : look(spec, altitudes).rows) {
    if (row.outcome != f64::RAY_SPACE || row.turning_points < 5) continue;
    ++through;
    EXPECT_LT(*row.true_altitude_deg, -4);
    EXPECT_GT(*row.true_altitude_deg, -5);
    EXPECT_GT(*row.ground_distance_m, 1.5e6);  // 400 km more than without the duct
    EXPECT_LT(row.min_height_m, 20);
  }
  EXPECT_GE(through, 10);
}

TEST(NovayaZemlya, ShowsNoSunWithoutTheDuct) {
  // oracle: without the inversion nothing below -1 degree is seen, as in any standard air
  // tolerance: as the words say
  ProfileSpec spec = load_profile("novaya-zemlya", "", {});
  spec.inversions.clear();
  for (const RefractionRow &row : look(spec, {-0.11, -0.05, 0, 0.05, 0.1, 0.3}).rows)
    if (row.outcome == f64::RAY_SPACE) {
      EXPECT_GT(*row.true_altitude_deg, -1);
    }
}

TEST(SolverChoice, LayersServeWhereNothingVaries) {
  // oracle: the planner's rule, in words
  // tolerance: exact
  const ProfileSpec varying = load_profile("novaya-zemlya", "", {});
  ProfileSpec still = varying;
  for (InversionSpec &v : still.inversions) v.delta_T_K = 8.0, v.height_m.value.assign(3, 50.0);
  const auto choose = [](const ProfileSpec &spec, const char *method) { return choose_solver(spec, method, {}); };
  EXPECT_TRUE(choose(varying, "auto").section);
  EXPECT_EQ(choose(varying, "auto").method, RayMethod::dormand_prince);
  EXPECT_EQ(choose(varying, "richardson").method, RayMethod::richardson);
  EXPECT_THROW(choose(varying, "cells"), InputError);
  EXPECT_FALSE(choose(still, "auto").section);
  EXPECT_EQ(choose(still, "auto").method, RayMethod::cells);
  EXPECT_NE(choose(still, "auto").why.find("change nothing"), std::string::npos);
  EXPECT_TRUE(choose(still, "rk").section);
  EXPECT_FALSE(choose(ProfileSpec{}, "rk").section);
  EXPECT_TRUE(choose(ProfileSpec{}, "section").section);
}

TEST(SectionCurve, HasTheImagesOfTheClosedForm) {
  // oracle: the curve of the closed form, whose jumps are known exactly, for air in which nothing varies
  // tolerance: outcome equal but within 1e-6 degree of a jump; true altitude 0.01 arcsec over max(1, |d true/d
  // apparent|)
  const AirSection air(parse_profile("air.toml", "[[inversion]]\ndelta_T_K = 8\nheight_m = 50\ndiffuseness_m = 5\n"));
  SkyRayOptions options;
  options.height_m = 60;
  options.precision = Precision::double_;
  options.error_arcsec = 1e-4;
  SkyRays layers(air.at(0), {550}, options, shared_device());
  options.method = RayMethod::dormand_prince;
  options.step_rad = 1e-11;
  SkyRays section(air, {550}, options, shared_device());
  const TransferCurve a = trace_transfer_curve(layers, to_rad(-0.6), to_rad(0.8), 0.01);
  const TransferCurve b = trace_transfer_curve(section, to_rad(-0.6), to_rad(0.8), 0.01);
  for (double true_deg : {-1.2, -0.8, -0.6, -0.5, -0.45, -0.2, 0.0, 0.3}) {
    const auto of_a = images_of(a, 0, to_rad(true_deg)), of_b = images_of(b, 0, to_rad(true_deg));
    ASSERT_EQ(of_a.size(), of_b.size()) << true_deg;
    for (std::size_t i = 0; i < of_a.size(); ++i) {
      EXPECT_EQ(of_a[i].erect, of_b[i].erect) << true_deg;
      EXPECT_NEAR(of_a[i].apparent_altitude_deg, of_b[i].apparent_altitude_deg, 0.03 / 3600) << true_deg;
    }
  }
}

Scene scene_of(const std::string &words) {
  return load_scene("novaya-zemlya",
                    [&] {
                      std::vector<std::string> all{"observer.resolution=[48, 36]", "spectrum.samples=3",
                                                   "tracing.quality={ spp = 4 }"};
                      if (!words.empty()) all.push_back(words);
                      return all;
                    }(),
                    {});
}

double brightest(const SpectralImage &image) {
  double most = 0;
  for (float radiance : image.radiance) most = std::max(most, static_cast<double>(radiance));
  return most;
}

TEST(NovayaZemlya, MakesAPicture) {
  // oracle: the Sun's disk is some thousand times brighter than the twilight around it; with the Sun 8 degrees below,
  //         where no ray of the duct comes from, there is none
  // tolerance: a factor 100
  RenderOptions options;
  const Scene scene = scene_of(""), night = scene_of("sun.altitude_deg=-8");
  const RenderPlan plan = plan_render(scene, options);
  EXPECT_TRUE(plan.section);
  const Rendered seen = render(scene, plan, options, shared_device());
  const Rendered dark = render(night, plan_render(night, options), options, shared_device());
  EXPECT_GT(brightest(seen.image), 100 * brightest(dark.image));
  EXPECT_LT(seen.report.table_arcsec, 0.5);
  EXPECT_LT(seen.report.solver_arcsec, 0.5);
  ASSERT_TRUE(seen.report.sun_apparent_altitude_deg);
  EXPECT_NEAR(*seen.report.sun_apparent_altitude_deg, 0, 0.12);
}

}  // namespace
}  // namespace greenray
