// Eyes in the dark: detail and colour that are lost, and what the rods see.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "image/picture_sink.hpp"
#include "image/picture_source.hpp"
#include "vision/acuity.hpp"
#include "vision/display_rows.hpp"
#include "vision/human_eye.hpp"

namespace greenray::vision {
namespace {

struct Seen {
  RgbImage picture;
  EyeReport report;
};

Seen see(const EyeOptions &options, const RgbImage &image, double fov_deg) {
  Seen seen;
  const auto source = picture_source(image, fov_deg);
  const auto sink = memory_sink(seen.picture, image.width, image.height);
  seen.report = HumanEye(options).develop(*source, *sink);
  return seen;
}

/// Squares of `side` pixels, as bright as 1.5 and 0.5 times the mean.
RgbImage chessboard(int size, int side, double mean_cd_m2) {
  RgbImage image{size, size, std::vector<float>(3 * static_cast<std::size_t>(size * size))};
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double level = mean_cd_m2 * ((x / side + y / side) % 2 ? 1.5 : 0.5);
      image.set_pixel(static_cast<std::size_t>(y * size + x), {level, level, level});
    }
  return image;
}

EyeOptions resolving(bool acuity) {
  EyeOptions options;
  options.glare = false;
  options.rods = RodVision::off;
  options.acuity = acuity;
  options.sensitivity = false;  // else all of it is black
  return options;
}

/// One pixel of this light through display_rows: luminance of the mix, and the largest difference of its channels.
struct Mix {
  double luminance, colour;
};

Mix mixed(RodVision rods, float y, float scotopic) {
  const ToneTable tone(ToneCurve(histogram_from_table({-6, -5}, {1, 1}), {100, 100}, false));
  const float x = 1.5F * y, z = 0.1F * y;  // a red
  float luminance = y, rgb[3];
  display_rows(tone, rods, 1, &x, &y, &z, &luminance, &scotopic, rgb);
  return {static_cast<double>(luminance), static_cast<double>(rgb[0] - rgb[2]) / static_cast<double>(rgb[1])};
}

}  // namespace

// oracle: Shaler's curve as Ward Larson et al. 1997 give it, 17.25 arctan(1.4 log10 La + 0.35) + 25.72 cycles/deg, by a
//         pocket calculator.  tolerance: digits printed
TEST(Dark, AcuityOfShaler) {
  EXPECT_NEAR(acuity_cycles_deg(1e-3), 3.0074, 1e-4);
  EXPECT_NEAR(acuity_cycles_deg(0.1), 11.7512, 1e-4);
  EXPECT_NEAR(acuity_cycles_deg(1), 31.5276, 1e-4);
  EXPECT_NEAR(acuity_cycles_deg(1000), 49.0844, 1e-4);
  EXPECT_GT(acuity_cycles_deg(0), 0);
}

// oracle: one sample of the eye is 1/R degrees; a chessboard finer than that is a grey, one much coarser stays, and by
// day
//         nothing changes.  tolerance: 1 % of the sample; contrast by 20 to 1 and 10 %; by day no bit
TEST(Dark, FineDetailIsLostCoarseIsKept) {
  constexpr int size = 300;
  constexpr double fov_deg = 15, dark = 1e-3;
  const double pixel_deg = 2 * std::tan(fov_deg / 2 * M_PI / 180) / size / (M_PI / 180);
  const auto contrast = [](const Seen &seen) {
    float least = 1, most = 0;
    for (int y = 60; y < 240; ++y)
      for (int x = 60; x < 240; ++x) {
        const float v = seen.picture.rgb[3 * static_cast<std::size_t>(y * size + x)];
        least = std::min(least, v), most = std::max(most, v);
      }
    return static_cast<double>(most - least);
  };
  const RgbImage fine = chessboard(size, 2, dark), coarse = chessboard(size, 100, dark);
  const Seen blurred = see(resolving(true), fine, fov_deg), sharp = see(resolving(false), fine, fov_deg);
  EXPECT_TRUE(blurred.report.acuity_applied);
  EXPECT_NEAR(blurred.report.coarsest_sample_pixels * pixel_deg * 3.0074, 1, 0.01);
  EXPECT_LT(contrast(blurred), contrast(sharp) / 20);
  EXPECT_NEAR(contrast(see(resolving(true), coarse, fov_deg)) / contrast(see(resolving(false), coarse, fov_deg)), 1,
              0.1);
  const RgbImage day = chessboard(size, 2, 1000);
  EXPECT_EQ(see(resolving(true), day, fov_deg).picture.rgb, see(resolving(false), day, fov_deg).picture.rgb);
}

// oracle: Ward Larson et al. 1997, colour sensitivity: below 5.62e-3 cd/m2 the rods alone, grey of a luminance of
//         scotopic / 2.26 (equal-energy white as bright to both); above 5.62 the cones alone; a straight mix between
// tolerance: float
TEST(Dark, WardsMesopicRamp) {
  const Mix night = mixed(RodVision::ward, 1e-3F, 4.52e-3F), day = mixed(RodVision::ward, 6.0F, 100.0F);
  EXPECT_NEAR(night.luminance / 2e-3, 1, 1e-6);
  EXPECT_NEAR(night.colour, 0, 1e-6);
  EXPECT_NEAR(day.luminance / 6, 1, 1e-6);
  EXPECT_NEAR(day.colour, mixed(RodVision::off, 6.0F, 0.0F).colour, 1e-6);
  const double y = 1.0, share = (1.0 - 5.62e-3) / (5.62 - 5.62e-3);
  const Mix dusk = mixed(RodVision::ward, 1.0F, 9.04F);
  EXPECT_NEAR(dusk.luminance / (share * y + (1 - share) * 4), 1, 1e-6);
  EXPECT_GT(dusk.colour, 0.01);
  EXPECT_LT(dusk.colour, 0.5 * day.colour);
  EXPECT_EQ(cone_share(0), 0);
  EXPECT_EQ(cone_share(1e6), 1);
}

// oracle: CIE 191:2010: photopic from 5 cd/m2 on, scotopic to 0.005, and between them both of its equations hold
// tolerance: 1e-3, its constants have four digits; 1e-6 of the equations
TEST(Dark, Cie191) {
  EXPECT_NEAR(cie191(5, 12).luminance_cd_m2 / 5, 1, 2e-3);
  EXPECT_NEAR(cie191(5, 12).cone_share, 1, 1e-3);
  EXPECT_NEAR(cie191(0.002, 0.005).cone_share, 0, 1e-3);
  EXPECT_NEAR(cie191(0.002, 0.004).luminance_cd_m2 / 0.004, 1, 1e-6);
  EXPECT_EQ(cie191(0, 0).luminance_cd_m2, 0);
  for (const double photopic : {0.01, 0.1, 0.3, 1.0, 3.0})
    for (const double ratio : {0.3, 1.0, 2.5}) {
      const Mesopic m = cie191(photopic, ratio * photopic);
      EXPECT_NEAR(m.cone_share, std::clamp(0.7670 + 0.3334 * std::log10(m.luminance_cd_m2), 0.0, 1.0), 1e-6);
      const double rods = (1 - m.cone_share) * 683 / 1699;
      EXPECT_NEAR((m.cone_share * photopic + rods * ratio * photopic) / (m.cone_share + rods) / m.luminance_cd_m2, 1,
                  1e-6);
    }
}

// oracle: scotopic over photopic luminance of equal energy (2.26), D65 (2.47) and CIE A (1.41), known from V and V'.
// tolerance: 5 %: the fit is one of three numbers
TEST(Dark, ScotopicFromColour) {
  EXPECT_NEAR(scotopic_from_xyz(1, 1, 1) / 2.26, 1, 0.05);
  EXPECT_NEAR(scotopic_from_xyz(0.9505, 1, 1.0891) / 2.47, 1, 0.05);
  EXPECT_NEAR(scotopic_from_xyz(1.0985, 1, 0.3558) / 1.41, 1, 0.11);
  EXPECT_EQ(scotopic_from_xyz(0, 1, 1), 0);
}

// oracle: Ward Larson et al. 1997: rods count where a twentieth of the picture is darker than the top of mesopic vision
// tolerance: a bin of the histogram, 15 % of the luminance
TEST(Dark, TheDarkestTwentiethDecides) {
  for (const auto &[dark_rows, rods] : {std::pair{20, true}, {2, false}}) {
    RgbImage image{100, 100, std::vector<float>(3 * 100 * 100, 100.0F)};
    std::fill_n(image.rgb.begin(), 3 * 100 * dark_rows, 1e-3F);
    EyeOptions options = resolving(false);
    options.rods = RodVision::ward;
    const EyeReport report = see(options, image, 90).report;
    EXPECT_EQ(report.rods_applied, rods);
    EXPECT_NEAR(std::log(report.fifth_percentile_cd_m2 / (rods ? 1e-3 : 100)), 0, 0.15);
  }
}

}  // namespace greenray::vision
