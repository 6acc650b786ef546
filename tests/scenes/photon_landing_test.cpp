// Where photons land: emission of every kind of light, curved beams against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "atmosphere/profile.hpp"
#include "support_code/room_photons.hpp"

namespace greenray {
namespace {

const std::string camera = "greenray = 1\n[camera]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\n[spectrum]\nsamples = 1\n";

/// A black ball, 10 m, around lights at its middle: where a photon lands is where it was sent.
RoomScene in_black_ball(const std::string &light) {
  return parse_room("ball.toml", camera + "[[sphere]]\ncentre = [0, 0, 0]\nradius_m = 10\nreflectance = 0\n" + light);
}

double limit_of_chi_square(std::size_t freedom) {  // once in 1e7; Wilson & Hilferty 1931
  const double n = static_cast<double>(freedom), d = 2 / (9 * n);
  return n * std::pow(1 - d + 5.2 * std::sqrt(d), 3);
}

/// share: of the angle from the axis, a number that should be even in 0..1; the angle about it should be, too.
double chi_square_about(const LandedPhotons &landed, const Triple &axis,
                        const std::function<double(double cosine)> &share) {
  constexpr int rows = 12, columns = 16;
  std::vector<double> seen(rows * columns, 0.0);
  const Triple first = unit(cross(axis, std::abs(axis[0]) < 0.5 ? Triple{1, 0, 0} : Triple{0, 1, 0}));
  const Triple second = cross(axis, first);
  for (std::size_t i = 0; i < landed.count(); ++i) {
    const Triple d = unit(landed.place(i));
    const double turn = std::atan2(dot(d, second), dot(d, first)) / (2 * M_PI) + 0.5;
    const int row = std::clamp(static_cast<int>(rows * share(dot(d, axis))), 0, rows - 1);
    const int column = std::clamp(static_cast<int>(columns * turn), 0, columns - 1);
    seen[static_cast<std::size_t>(row * columns + column)] += 1;
  }
  const double expected = static_cast<double>(landed.count()) / (rows * columns);
  double sum = 0;
  for (const double s : seen) sum += (s - expected) * (s - expected) / expected;
  return sum;
}

// oracle: even in solid angle: the share of a cone within an angle is (1 - cos)/(1 - cos half); of a plane lamp, sin^2
// tolerance: chi-square of 192 bins, probability 1e-7
TEST(Emission, DirectionsOfEveryLight) {
  constexpr std::uint32_t count = 200000;
  const LandedPhotons point =
      land_photons(in_black_ball("[[light]]\nkind = \"point\"\nfrom = [0, 0, 0]\npower_W = 1\n"), count);
  ASSERT_EQ(point.count(), count);
  EXPECT_LT(chi_square_about(point, {0, 0, 1}, [](double c) { return (1 - c) / 2; }), limit_of_chi_square(191));

  const Triple axis = unit({1, 2, -2});
  const LandedPhotons spot = land_photons(
      in_black_ball("[[light]]\nkind = \"spot\"\nfrom = [0, 0, 0]\nto = [1, 2, -2]\ncone_deg = 50\npower_W = 1\n"),
      count);
  ASSERT_EQ(spot.count(), count);
  const double half = 1 - std::cos(25 * M_PI / 180);
  EXPECT_LT(chi_square_about(spot, axis, [&](double c) { return (1 - c) / half; }), limit_of_chi_square(191));

  // A lamp of 1 mm: seen from 10 m its size shifts a direction by 1e-4, far less than a bin.
  const LandedPhotons area = land_photons(
      in_black_ball("[[quad]]\nname = \"lamp\"\ncorner = [-5e-4, -5e-4, 0]\nedge_u = [1e-3, 0, 0]\nedge_v = [0, 1e-3, "
                    "0]\nreflectance = 0\n[[light]]\nkind = \"area\"\nsurface = \"lamp\"\npower_W = 1\n"),
      count);
  ASSERT_EQ(area.count(), count);
  EXPECT_LT(chi_square_about(area, {0, 0, 1}, [](double c) { return 1 - c * c; }), limit_of_chi_square(191));
}

// oracle: parallel light of irradiance E on a floor: E sin(altitude), the same everywhere
// tolerance: 5 Poisson errors of each of 64 squares
TEST(Emission, SunOnAFloor) {
  const double irradiance = 800, altitude_deg = 40;
  const RoomScene scene = parse_room(
      "floor.toml", camera +
                        "[[quad]]\ncorner = [-2, -2, 0]\nedge_u = [4, 0, 0]\nedge_v = [0, 4, 0]\nreflectance = 0\n"
                        "[[light]]\nkind = \"sun\"\naltitude_deg = 40\nazimuth_deg = 130\nirradiance_W_m2 = 800\n");
  const LandedPhotons landed = land_photons(scene, 400000);
  std::vector<double> power(64, 0.0), count(64, 0.0);
  for (std::size_t i = 0; i < landed.count(); ++i) {
    const Triple p = landed.place(i);
    const auto x = static_cast<std::size_t>(std::clamp((p[0] + 2) * 2, 0.0, 7.0)),
               y = static_cast<std::size_t>(std::clamp((p[1] + 2) * 2, 0.0, 7.0));
    power[8 * y + x] += static_cast<double>(landed.map.power_W[i]), count[8 * y + x] += 1;
  }
  for (std::size_t i = 0; i < 64; ++i) {
    ASSERT_GT(count[i], 100);
    EXPECT_NEAR(power[i] / 0.25, irradiance * std::sin(altitude_deg * M_PI / 180),
                5 * irradiance / std::sqrt(count[i]));
  }
}

/// n = n0 + g h in a flat medium: a ray is a catenary, n = q cosh(g (x - x0)/q), q = n cos(elevation). Height at x of
/// the ray from (0, z) with a slope.
struct Catenary {
  double n0, g;
  double height_m(double z, double slope, double x) const {
    const double n = n0 + g * z, q = n / std::sqrt(1 + slope * slope);
    return (q * std::cosh(g * x / q + std::asinh(slope)) - n0) / g;
  }
  /// The slope with which a ray from (0, z) reaches (x, height).
  double slope_to(double z, double x, double height) const {
    double low = -1, high = 1;
    for (int i = 0; i < 200; ++i) (height_m(z, 0.5 * (low + high), x) < height ? low : high) = 0.5 * (low + high);
    return 0.5 * (low + high);
  }
};

// oracle: the catenary through the spot and each edge of the slit, on to the wall
// tolerance: 1 mm, asked of curved photons; both edges are struck to 0.3 mm by the outermost of the photons
TEST(CurvedPhotons, BeamThroughASlitLandsWhereTheCatenarySays) {
  const Catenary air{1.0, 0.03};
  const double slit_x = 2, low = 0.995, high = 1.005, wall_x = 8, from = 1.2;
  const RoomScene scene = parse_room(
      "slit.toml",
      camera +
          "[atmosphere]\nfield = { kind = \"layers\", height_m = [0.0, 3.0], refractivity = [0.0, 0.09] }\n"
          // the screen with its slit, black; the wall behind it
          "[[quad]]\ncorner = [2, -1, 0]\nedge_u = [0, 2, 0]\nedge_v = [0, 0, 0.995]\nreflectance = 0\n"
          "[[quad]]\ncorner = [2, -1, 1.005]\nedge_u = [0, 2, 0]\nedge_v = [0, 0, 1.995]\nreflectance = 0\n"
          "[[quad]]\ncorner = [8, -1, 0]\nedge_u = [0, 2, 0]\nedge_v = [0, 0, 3]\nreflectance = 0\n"
          "[[light]]\nkind = \"spot\"\nfrom = [0, 0, 1.2]\nto = [2, 0, 0.94]\ncone_deg = 4.0\npower_W = 1\n");
  const LandedPhotons landed = land_photons(scene, 400000);
  double lowest = 1e9, highest = -1e9, straight_low = from + (low - from) * wall_x / slit_x;
  for (std::size_t i = 0; i < landed.count(); ++i) {
    const Triple p = landed.place(i);
    if (p[0] < 7 || std::abs(p[1]) > 5e-3) continue;  // the middle plane, where the closed form holds
    lowest = std::min(lowest, p[2]), highest = std::max(highest, p[2]);
  }
  const double expect_low = air.height_m(from, air.slope_to(from, slit_x, low), wall_x);
  const double expect_high = air.height_m(from, air.slope_to(from, slit_x, high), wall_x);
  EXPECT_NEAR(lowest, expect_low, 1e-3);
  EXPECT_NEAR(highest, expect_high, 1e-3);
  EXPECT_GT(expect_low - straight_low, 0.3) << "and it is bent by far more than that";
}

/// Height after `distance_m` along the ground of a ray from a height with a slope, by Runge and Kutta's method on
/// z'' = (1 + z'^2) (d ln n/dz), 0.5 mm steps in the thin hot layer: n from the profile itself, no table.
double ray_height_m(const LayeredMedium &air, double z, double slope, double distance_m) {
  const auto bend = [&](double h, double s) {
    const Dual n = air.refractivity(std::clamp(h, 0.0, 3.0), 550);
    return h < 0 || h > 3 ? 0.0 : (1 + s * s) * n.slope / (1 + n.value);
  };
  constexpr int steps = 6000;
  const double d = distance_m / steps;
  for (int i = 0; i < steps; ++i) {
    const double k1 = bend(z, slope), k2 = bend(z + d / 2 * slope, slope + d / 2 * k1),
                 k3 = bend(z + d / 2 * (slope + d / 2 * k1), slope + d / 2 * k2),
                 k4 = bend(z + d * (slope + d / 2 * k2), slope + d * k3);
    z += d * (slope + d / 6 * (k1 + k2 + k3));
    slope += d / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return z;
}

// oracle: rays of the profile itself in double, from the spot through all heights of the bar of the cross, to the wall
// tolerance: 6 mm: bins of 5 mm and the table's 1 mm; the shift is 0.44 m
TEST(CurvedPhotons, CrossIsShiftedByWhatTheRaysOfTheProfileSay) {
  const std::string file = std::string(GREENRAY_SOURCE) + "/scenes/cross-room.toml";
  std::ifstream in(file);
  const RoomScene scene = parse_room(file, std::string{std::istreambuf_iterator<char>(in), {}}, {"spectrum.samples=1"});
  const Profile profile(*scene.air);
  const LayeredMedium air = layered_medium(profile, true);
  const double window_m = std::hypot(6, 0.45), from = 1.8;  // the plane through the spot and y = 0.45 in the window
  double lowest = 1e9, highest = -1e9;
  for (int i = 0; i <= 60; ++i) {
    const double edge = 2.1 + 0.3 * i / 60;
    double low = -0.2, high = 0.3;
    for (int k = 0; k < 40; ++k) {
      const double slope = 0.5 * (low + high);
      (ray_height_m(air, from, slope, window_m) < edge ? low : high) = slope;
    }
    const double lands = ray_height_m(air, from, 0.5 * (low + high), 2 * window_m);
    lowest = std::min(lowest, lands), highest = std::max(highest, lands);
  }
  for (const bool straight : {false, true}) {
    const LandedPhotons landed = land_photons(scene, 600000, straight);
    std::vector<double> heights;
    for (std::size_t i = 0; i < landed.count(); ++i) {
      const Triple p = landed.place(i);
      if (p[0] > 5.99 && std::abs(std::abs(p[1]) - 0.9) < 0.06) heights.push_back(p[2]);
    }
    // The bar is where photons are dense: most of them, without the few that came from other walls.
    std::sort(heights.begin(), heights.end());
    std::vector<int> bins(600, 0);
    for (const double z : heights) ++bins[static_cast<std::size_t>(std::clamp(z / 0.005, 0.0, 599.0))];
    std::vector<int> sorted = bins;
    std::sort(sorted.begin(), sorted.end());
    const int dense = 6 * sorted[200] + 12;  // most of the wall's height is lit by other walls only
    int first = 599, last = 0;
    for (int b = 0; b < 600; ++b)
      if (bins[static_cast<std::size_t>(b)] > dense) first = std::min(first, b), last = std::max(last, b);
    if (straight) {
      EXPECT_NEAR(0.005 * first, 2 * 2.1 - from, 0.006);
      EXPECT_NEAR(0.005 * (last + 1), 2 * 2.4 - from, 0.006) << "where the wall meets the ceiling";
    } else {
      EXPECT_NEAR(0.005 * first, lowest, 0.006);
      EXPECT_NEAR(0.005 * (last + 1), highest, 0.006);
      EXPECT_LT(highest, 2 * 2.4 - from - 0.5) << "folded upon itself";
      EXPECT_LT(lowest, 2 * 2.1 - from - 0.1) << "away from the hot ceiling";
    }
  }
}

}  // namespace
}  // namespace greenray
