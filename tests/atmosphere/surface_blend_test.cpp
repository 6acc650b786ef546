#include "atmosphere/surface_blend.hpp"

#include <gtest/gtest.h>

#include "atmosphere/profile.hpp"
#include "atmosphere/profile_file.hpp"

namespace greenray {
namespace {

double temperature(const ProfileSpec &spec, double height_m) { return Profile(spec).air(height_m).temperature_K.value; }

const SourcePlace here{"command line", 1, 1};

// oracle: the rule itself: the water's temperature at 0, a hundredth of the difference left at top_m
// tolerance: rounding
TEST(SurfaceBlend, water_alone_warms_the_profile_from_below) {
  ProfileSpec spec = parse_profile("a.toml", "");
  blend_surface(spec, {290.15, std::nullopt, 40}, here);
  EXPECT_NEAR(temperature(spec, 0), 290.15, 1e-9);
  EXPECT_NEAR(temperature(spec, 40), 288.15 - 0.0065 * 40 + 0.01 * 2, 1e-4);
  EXPECT_EQ(spec.notes.size(), 1u);
}

// oracle: the two thermometers
// tolerance: rounding
TEST(SurfaceBlend, air_takes_the_place_of_the_rows_below_the_top) {
  ProfileSpec spec = parse_profile("a.toml",
                                   "base = \"none\"\n[[level]]\nheight_m = 5.0\ntemperature_K = 286.0\npressure_Pa = "
                                   "100900.0\nrelative_humidity = 0.8\n"
                                   "[[level]]\nheight_m = 300.0\ntemperature_K = 287.0\npressure_Pa = "
                                   "97400.0\nrelative_humidity = 0.5\n[[inversion]]\n"
                                   "delta_T_K = 3.0\nheight_m = 25.0\ndiffuseness_m = 5.0\n");
  const double surface_Pa = Profile(spec).spec().surface_pressure_Pa;
  blend_surface(spec, {287.35, 291.75, 40}, here);
  ASSERT_EQ(spec.levels.size(), 3u);
  EXPECT_NEAR(temperature(spec, 0), 287.35, 1e-9);
  EXPECT_NEAR(temperature(spec, 40), 291.75 - 0.01 * 4.4, 1e-9);
  EXPECT_EQ(spec.levels[0].relative_humidity, 0.8);
  EXPECT_NEAR(spec.levels[1].relative_humidity.value(), 0.8 - 0.3 * 35 / 295, 1e-12);
  // oracle: the rule: the surface pressure stays;  tolerance: rounding
  EXPECT_NEAR(Profile(spec).spec().surface_pressure_Pa, surface_Pa, 1e-6);
  // It reads back as it was written.
  const ProfileSpec again = parse_profile("a.toml", write_profile(spec));
  for (const double h : {0.0, 3.0, 40.0, 200.0}) EXPECT_EQ(temperature(again, h), temperature(spec, h)) << h;
}

// oracle: the documented limits
// tolerance: none
TEST(SurfaceBlend, nonsense_is_an_error_at_its_place) {
  ProfileSpec air = parse_profile("a.toml", "");
  EXPECT_THROW(blend_surface(air, {290, std::nullopt, 0}, here), InputError);
  EXPECT_THROW(blend_surface(air, {20, std::nullopt, 40}, here), InputError);
  ProfileSpec medium = parse_profile("m.toml", "[[index_level]]\nheight_m = 0.0\nrefractivity = 0.1\n");
  EXPECT_THROW(blend_surface(medium, {290, std::nullopt, 40}, here), InputError);
}

}  // namespace
}  // namespace greenray
