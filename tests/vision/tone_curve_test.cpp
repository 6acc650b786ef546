// Histogram adjustment against pcond's maps and against an implementation of its own in Python.
#include "vision/tone_curve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "support/csv_table.hpp"
#include "vision/eye_data.hpp"

namespace greenray::vision {

// oracle: maps that Radiance's `pcond -I` gives for hist_a.  tolerance: 1e-6, the digits printed
TEST(ToneCurve, EqualsPcond) {
  const auto [level, count] = eye_columns("hist_a.txt");
  for (const bool sensitivity : {false, true})
    for (const auto &[display, tail] :
         {std::pair{Display{100, 100}, "_u100d100.map.txt"}, {Display{250, 1000}, "_u250d1000.map.txt"}}) {
      const ToneCurve curve(histogram_from_table(level, count), display, sensitivity);
      const auto [world, shown] = eye_columns(std::string("histI_a_") + (sensitivity ? "s" : "n") + tail);
      const auto rows = curve.table();
      ASSERT_EQ(rows.size(), world.size());
      EXPECT_FALSE(curve.is_linear());
      for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_NEAR(rows[i].first / world[i], 1, 1e-6) << i;
        EXPECT_NEAR(rows[i].second / shown[i], 1, 1e-6) << i;
      }
    }
}

// oracle: tests/oracle/eye.py, six more histograms on three displays, linear fall-backs among them.  tolerance: 1e-7:
//         the same arithmetic in double, summed in another order
TEST(ToneCurve, EqualsTheOracleOnOtherHistograms) {
  std::ifstream file(eye_path("maps.csv"));
  std::string line;
  std::string last_key;
  std::vector<std::pair<double, double>> rows;
  int compared = 0, linear_rows = 0;
  while (std::getline(file, line)) {
    if (line.empty() || line[0] == '#' || line.rfind("histogram", 0) == 0) continue;
    char name[40];
    double ldmax = 0, contrast = 0, world = 0, shown = 0;
    int sensitivity = 0, linear = 0, bin = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%39[^,],%lf,%lf,%d,%d,%d,%lf,%lf", name, &ldmax, &contrast, &sensitivity,
                          &linear, &bin, &world, &shown),
              8);
    const std::string key = line.substr(0, line.find("," + std::to_string(linear) + ","));
    const auto [level, count] = eye_columns("hist_" + std::string(name) + ".txt");
    const ToneCurve curve(histogram_from_table(level, count), {ldmax, contrast}, sensitivity != 0);
    const auto row = curve.table().at(static_cast<std::size_t>(bin));
    EXPECT_EQ(curve.is_linear(), linear != 0) << line;
    EXPECT_NEAR(row.first / world, 1, 1e-7) << line;
    EXPECT_NEAR(row.second / shown, 1, 1e-7) << line;
    ++compared, linear_rows += linear;
  }
  EXPECT_EQ(compared, 504);
  EXPECT_GT(linear_rows, 100);
  EXPECT_LT(linear_rows, 400);
}

// oracle: what a map is for: more light never looks darker, nothing leaves the display.  tolerance: none
TEST(ToneCurve, NeverFallsAndStaysOnTheDisplay) {
  for (const char *name : {"hist_a.txt", "hist_sun.txt", "hist_spikes.txt", "hist_narrow.txt", "hist_below.txt"})
    for (const bool sensitivity : {false, true}) {
      const auto [level, count] = eye_columns(name);
      const ToneCurve curve(histogram_from_table(level, count), {100, 100}, sensitivity);
      double before = 0, before_fraction = 0;
      for (double l = 1e-9; l < 1e13; l *= 1.01) {
        const double shown = curve.display_cd_m2(l), fraction = curve.display_fraction(l);
        EXPECT_GE(shown, std::max(before, 1.0 - 1e-12)) << name << " " << l;
        EXPECT_LE(shown, 100 * (1 + 1e-12));
        EXPECT_GE(fraction, before_fraction) << name << " " << l;
        EXPECT_LE(fraction, 1);
        before = shown, before_fraction = fraction;
      }
      for (const double l : {0.0, -1.0, static_cast<double>(NAN)}) EXPECT_EQ(curve.display_fraction(l), 0);
      EXPECT_LE(curve.display_fraction(INFINITY), 1);
    }
}

// oracle: the method's ceiling: contrast is nowhere raised above that of the scene (plain), d(ln Ld)/d(ln Lw) <= 1.
// tolerance: the 2.5 % of samples that may exceed it, in few bins
TEST(ToneCurve, DoesNotExaggerateContrast) {
  const auto [level, count] = eye_columns("hist_sun.txt");
  const BrightnessHistogram histogram = histogram_from_table(level, count);
  const ToneCurve curve(histogram, {100, 100}, false);
  const auto rows = curve.table();
  int steep = 0;
  for (std::size_t i = 1; i < rows.size(); ++i)
    steep += std::log(rows[i].second / rows[i - 1].second) > 1.05 * std::log(rows[i].first / rows[i - 1].first);
  EXPECT_LE(steep, 10);
}

// oracle: rules of the header on samples: a constant picture is shown linear; no light, no curve; the Sun counts
// tolerance: none
TEST(ToneCurve, Samples) {
  const std::vector<float> one(4, 1.0F);
  const ToneCurve constant(histogram_from_samples({50, 50, 50, 50}, one, {50, 50}), {100, 100}, false);
  EXPECT_TRUE(constant.is_linear());
  EXPECT_NEAR(constant.display_cd_m2(50), 10, 1e-4) << "the geometric middle of the display";
  const BrightnessHistogram dark = histogram_from_samples({0, 0}, one, {0, 0});
  EXPECT_TRUE(dark.dark());
  EXPECT_EQ(ToneCurve(dark, {100, 100}, true).display_fraction(1), 0);
  const BrightnessHistogram sun = histogram_from_samples({1, 10, 100, 3e8F}, one, {1, 1.6e9F});
  EXPECT_GT(sun.high, std::log(1.6e9));
  EXPECT_NEAR(sun.total, 8, 1e-6) << "four foveal samples, and two points that weigh as much";
}

// oracle: the rules of the file.  tolerance: none
TEST(ToneCurve, WrongHistogramsAreRefused) {
  EXPECT_THROW(histogram_from_table({1}, {1}), std::domain_error);
  EXPECT_THROW(histogram_from_table({1, 2, 4}, {1, 1, 1}), std::domain_error);
  EXPECT_THROW(histogram_from_table({1, 2}, {0, 0}), std::domain_error);
  EXPECT_THROW(histogram_from_table({1, 2}, {-1, 1}), std::domain_error);
  EXPECT_THROW(histogram_from_table({2, 1}, {1, 1}), std::domain_error);
  EXPECT_THROW(histogram_from_table({20, 21}, {1, 1}), std::domain_error);
  EXPECT_THROW(ToneCurve(histogram_from_table({1, 2}, {1, 1}), {100, 1}, false), std::domain_error);
}

}  // namespace greenray::vision
