// The rough horizon: how high it stands, how rough it is, and what it hides.
#include <gtest/gtest.h>

#include <cmath>

#include "render/renderer.hpp"
#include "render/sea.hpp"
#include "scene/scene_file.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

constexpr double earth_m = 6371000, eye_m = 10;

std::string text(double value) {
  std::ostringstream out;
  out.precision(15);
  out << std::fixed << value;
  return out.str();
}

/// A bright wall far beyond the horizon under a black sky, and waves; straight light.
std::string scene_text(double wind_m_s, double distance_m, double height_m) {
  return "greenray = 1\n[sky]\nmodel = \"academic\"\n[atmosphere]\nextinction = false\n[spectrum]\nsamples = 1\n"
         "range_nm = [550.0, 550.0]\n[observer]\nheight_m = 10.0\nazimuth_deg = 0.0\n[sea]\nwind_m_s = " +
         text(wind_m_s) +
         "\n[[target]]\nkind = \"rectangle\"\nluminance_cd_m2 = 10.0\nwidth_m = 1e6\ndistance_m = " + text(distance_m) +
         "\nheight_m = " + text(height_m) + "\n";
}

constexpr double pixel_arcsec = 2;
constexpr int columns = 4000, rows = 60;

double dip_deg() { return -to_deg(std::acos(earth_m / (earth_m + eye_m))); }

Rendered make(const std::string &scene_lines, std::uint64_t seed) {
  const double half = std::tan(from_arcsec(pixel_arcsec)) * columns / 2;
  const Scene scene = parse_scene(
      "sea.toml", scene_lines,
      {"observer.altitude_deg=" + text(dip_deg() + 20.0 / 3600),
       "observer.fov_deg=" + text(2 * to_deg(std::atan(half))),
       "observer.resolution=[" + std::to_string(columns) + ", " + std::to_string(rows) + "]", "tracing.quality.spp=4"});
  RenderOptions options;
  options.straight = true;
  options.seed = seed;
  static const std::shared_ptr<Device> device = open_device({});
  return render(scene, plan_render(scene, options), options, device);
}

/// Lit share of each row, over the brightest pixel.
std::vector<double> lit_rows(const SpectralImage &image) {
  const float most = *std::max_element(image.radiance.begin(), image.radiance.end());
  std::vector<double> lit(rows, 0.0);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x)
      lit[static_cast<std::size_t>(y)] +=
          static_cast<double>(image.radiance[static_cast<std::size_t>(y * columns + x)] / most) / columns;
  return lit;
}

/// Mean number of crests in a straight ray's way up to a distance, by Simpson's rule in steps of 20 m.
double crests(const SeaState &sea, double altitude_rad, double distance_m) {
  const int steps = 2 * static_cast<int>(distance_m / 40);
  const double step = distance_m / steps;
  double sum = 0;
  for (int i = 0; i <= steps; ++i) {
    const double angle = i * step / earth_m;
    const double c = (earth_m + eye_m) * std::cos(altitude_rad) / std::cos(altitude_rad + angle) - earth_m;
    const double density = sea.slope / (2 * pi * sea.height_m) * std::exp(-0.5 * std::pow(c / sea.height_m, 2));
    sum += density * (i == 0 || i == steps ? 1 : i % 2 ? 4 : 2);
  }
  return sum * step / 3;
}

}  // namespace

// oracle: Pierson & Moskowitz: a wind of 10 m/s (10.26 at 19.5 m) raises 0.21 x 10.26^2/9.81 = 2.25 m; Cox & Munk: mean
// square
//         slope 0.003 + 0.00512 x 10 = 0.0542 in all
// tolerance: digits of the arithmetic
TEST(Sea, StateOfAWind) {
  const SeaState state = sea_state({true, 10, {}});
  EXPECT_NEAR(4 * state.height_m, 2.253, 0.001);
  EXPECT_NEAR(state.slope, std::sqrt(0.0542 / 2), 1e-6);
  EXPECT_NEAR(sea_state({true, 10, 1.0}).height_m, 0.25, 1e-12);
}

// oracle: exp(-N) clear, N by Simpson's rule along the straight ray (`crests`): a closed form of the path, another
// quadrature tolerance: six draws of some 28 independent crests each: 0.5/sqrt(168) = 4 % of coverage, three times that
// a row; 0.1 of it
//            for the mean height of the edge, whose spread is below 4" at one azimuth (0.3")
TEST(Sea, HorizonIsAsHighAndAsRoughAsTheWaves) {
  const double wall_m = 60000;
  const SeaState sea = sea_state({true, 8, {}});
  std::vector<double> found(rows, 0.0);
  constexpr int draws = 6;
  for (int seed = 1; seed <= draws; ++seed) {
    const std::vector<double> lit = lit_rows(make(scene_text(8, wall_m, 3000), static_cast<std::uint64_t>(seed)).image);
    for (std::size_t y = 0; y < found.size(); ++y) found[y] += lit[y] / draws;
  }
  double dark_rows = 0, expected_dark = 0;
  const double centre = to_rad(dip_deg()) + from_arcsec(20);
  for (int y = 0; y < rows; ++y) {
    double expected = 0;
    constexpr int parts = 8;
    for (int k = 0; k < parts; ++k) {
      const double altitude =
          centre + std::atan((rows / 2.0 - y - (k + 0.5) / parts) * std::tan(from_arcsec(pixel_arcsec)));
      expected += altitude > to_rad(dip_deg()) ? std::exp(-crests(sea, altitude, wall_m)) / parts : 0;
    }
    EXPECT_NEAR(found[static_cast<std::size_t>(y)], expected, 0.12) << y;
    dark_rows += 1 - found[static_cast<std::size_t>(y)];
    expected_dark += 1 - expected;
  }
  EXPECT_NEAR(dark_rows * pixel_arcsec, expected_dark * pixel_arcsec, 0.6);
  // The waves lift the edge by more than their own standard deviation, seen from 11.3 km; the dip lies 40" up.
  EXPECT_GT(dark_rows * pixel_arcsec - 40, to_arcsec(sea.height_m / 11288));
}

// oracle: crests beyond a target hide nothing of it, where the sea before it is far below the ray
// tolerance: none
TEST(Sea, HidesWhatStandsBehindIt) {
  const Rendered near = make(scene_text(8, 1000, 30), 1);
  const SpectralImage &image = near.image;
  const float most = *std::max_element(image.radiance.begin(), image.radiance.end());
  int lit = 0;
  for (const float radiance : image.radiance) lit += radiance > 0.999f * most;
  EXPECT_EQ(lit, columns * rows);  // the wall's foot lies 0.57 degrees down, below the picture
}

// oracle: thresholds are -ln of a uniform number: each tenth of 0..1 has a tenth of the azimuths; neighbours are alike
// within
//         the width and not beyond
// tolerance: 400 widths: three times sqrt(0.1 x 0.9/400) = 0.045; far correlation 0.3: three
//            times sqrt(0.5/64), what 64 cosines leave
TEST(Sea, ThresholdsAreExponentiallyDistributed) {
  const double width = 1e-3, step = width / 10;
  const std::vector<float> thresholds = crest_thresholds(0, step, 4000, width, 5);
  std::array<int, 10> bins{};
  std::vector<double> rank;
  for (const float t : thresholds) {
    rank.push_back(std::exp(-static_cast<double>(t)) - 0.5);
    ++bins[std::min<std::size_t>(9, static_cast<std::size_t>(10 * (rank.back() + 0.5)))];
  }
  for (const int n : bins) EXPECT_NEAR(n / 4000.0, 0.1, 0.045);
  const auto correlation = [&](std::size_t lag) {
    double product = 0, square = 0;
    for (std::size_t i = 0; i + lag < rank.size(); ++i) product += rank[i] * rank[i + lag], square += rank[i] * rank[i];
    return product / square;
  };
  EXPECT_GT(correlation(1), 0.95);
  EXPECT_LT(std::abs(correlation(50)), 0.3);
}

}  // namespace greenray
