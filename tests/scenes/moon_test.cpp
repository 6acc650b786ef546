// The Moon in pictures: eclipsed, by phase, and as it stands in the sky.
#include <gtest/gtest.h>

#include <cmath>

#include "render/renderer.hpp"
#include "scene/scene_file.hpp"
#include "support_code/reference_table.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

/// The middle of the disk of scene eclipsed-moon at 450, 550 and 650 nm, or between.
SpectralImage middle(std::vector<std::string> keys) {
  keys.insert(keys.end(), {"observer.resolution=[4, 3]", "observer.fov_deg=0.01", "observer.altitude_deg=8.01",
                           "tracing.quality={ spp = 8 }"});
  const Scene scene = load_scene("eclipsed-moon", keys, {});
  return render(scene, plan_render(scene, {}), {}, shared_device()).image;
}

double at(const SpectralImage &image, std::size_t wave) {
  return static_cast<double>(image.radiance[5 * image.wavelength_nm.size() + wave]);
}

}  // namespace

// oracle: earth_shadow.csv (tests/oracle/eclipse.py), for places 2000 and 2500 km from the axis: shadow_arcmin [12,
// -14] is
//         18.44' of a disk of 31.09', 3474.8 km: 2061 km. Outside the shadow the Moon shines through the same air
// tolerance: 20 %: the scene has haze at the limb (1 % of 120 km visibility) and real coefficients, the table round
// ones
TEST(MoonPicture, CopperLightInTheUmbra) {
  const testing_data::ReferenceTable table("earth_shadow.csv");
  const testing_data::ReferenceRow *near = nullptr, *far = nullptr;
  for (const testing_data::ReferenceRow &row : table.rows()) {
    if (row.number("from_axis_km") == 2000) near = &row;
    if (row.number("from_axis_km") == 2500) far = &row;
  }
  ASSERT_TRUE(near && far);
  for (const auto &[nm, name] : {std::pair{"550", "share_550"}, std::pair{"650", "share_650"}}) {
    const std::vector<std::string> one{"spectrum.samples=1", std::string("spectrum.range_nm=[") + nm + ", " + nm + "]"};
    std::vector<std::string> open = one;
    open.push_back("moon.shadow_arcmin=[300.0, 0.0]");
    const double share = at(middle(one), 0) / at(middle(open), 0);
    const double expected = std::pow(near->number(name), 0.878) * std::pow(far->number(name), 0.122);
    EXPECT_NEAR(share / expected, 1, 0.2) << nm;
  }
}

// oracle: Lommel & Seeliger: 2 mu0/(mu0 + mu) in the middle of the disk is 2 cos a/(cos a + 1) at a phase of a, times
// the
//         phase factor that Allen's law asks for: 10^(-0.4 (0.026 a + 4e-9 a^4)) over the law's own
//         1 - sin(a/2) tan(a/2) ln cot(a/4)
// tolerance: 1 %: the pixel lies 0.08' beside the middle towards the Sun, which stands to the right: 0.6 % at 60
// degrees
TEST(MoonPicture, PhasesDarkenTheMiddle) {
  const std::vector<std::string> open{"spectrum.samples=1", "spectrum.range_nm=[550, 550]",
                                      "moon.shadow_arcmin=[300.0, 0.0]"};
  const double full = at(middle(open), 0);
  for (const double deg : {30.0, 60.0}) {
    std::vector<std::string> keys = open;
    keys.insert(keys.end(), {"moon.phase_angle_deg=" + std::to_string(deg), "moon.bright_limb_deg=90.0"});
    const double a = deg * 3.14159265358979 / 180;
    const double own = 1 - std::sin(a / 2) * std::tan(a / 2) * std::log(1 / std::tan(a / 4));
    const double factor = std::pow(10, -0.4 * (0.026 * deg + 4e-9 * std::pow(deg, 4))) / own;
    EXPECT_NEAR(at(middle(keys), 0) / full / (factor * 2 * std::cos(a) / (std::cos(a) + 1)), 1, 0.01) << deg;
  }
}

}  // namespace greenray
