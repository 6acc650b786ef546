// The transfer curve against rays traced one by one, by steps in double on the host: another method and other code.
#include "render/transfer_curve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "render/host_rays.hpp"
#include "support/angle.hpp"
#include "support/error.hpp"
#include "support_code/reference_table.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

using testing_data::reference_profile;

struct Air {
  const char *profile;
  double height_m, low_deg, high_deg;
};

const std::vector<Air> airs{{"us76", 2, -0.6, 3},
                            {"us76", 1000, -2, 2},
                            {"thin_fermi", 12, -0.3, 0.5},
                            {"duct_10K", 45, -0.5, 0.5},
                            {"hot_road_thick", 1.5, -0.4, 0.4},
                            {"two_inversions", 30, -0.4, 0.6},
                            {"linear_levels", 70, -0.6, 1}};

class TransferCurves : public ::testing::TestWithParam<Air> {
 protected:
  static constexpr double tolerance_arcsec = 0.01;

  TransferCurve curve() const {
    SkyRayOptions options;
    options.height_m = GetParam().height_m;
    options.precision = Precision::double_;
    options.error_arcsec = tolerance_arcsec / 10;
    SkyRays rays(air(), {450, 650}, options, shared_device());
    return trace_transfer_curve(rays, to_rad(GetParam().low_deg), to_rad(GetParam().high_deg), tolerance_arcsec);
  }
  const Profile &air() const { return reference_profile(GetParam().profile); }
  IndexTable table() const {
    return build_index_table(air(), {450, 650}, IndexTableOptions{false, 1e-5, GetParam().height_m});
  }
  f64::RayEnd stepped(const IndexTable &t, std::size_t wave, double elevation_rad) const {
    return trace_on_host(t, wave, GetParam().height_m, elevation_rad);
  }
};

TEST_P(TransferCurves, InterpolateToTheTolerance) {
  // oracle: Dormand-Prince in double at 300 random elevations (seed 7)
  // tolerance: twice the tolerance asked for, over max(1, |dR/da|) by the interval's own secant: halfway is checked by
  // the
  //            curve itself, elsewhere in an interval the error of a straight line is no larger but for its cubic part
  const TransferCurve c = curve();
  const IndexTable t = table();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> anywhere(c.elevation_rad.front(), c.elevation_rad.back());
  int compared = 0;
  for (int i = 0; i < 300; ++i) {
    const double e = anywhere(random);
    const auto next = std::upper_bound(c.elevation_rad.begin(), c.elevation_rad.end(), e);
    const std::size_t k = static_cast<std::size_t>(next - c.elevation_rad.begin()) - 1;
    for (std::size_t w = 0; w < 2; ++w) {
      if (!c.joined(k, w)) continue;
      const f64::RayEnd ray = stepped(t, w, e);
      ASSERT_EQ(ray.outcome, c.at(k, w).outcome) << to_deg(e);
      if (ray.outcome == f64::RAY_TRAPPED) continue;
      const double width = c.elevation_rad[k + 1] - c.elevation_rad[k], f = (e - c.elevation_rad[k]) / width;
      const double rise = c.at(k + 1, w).bending_rad - c.at(k, w).bending_rad;
      const double stretch = std::max(1.0, std::abs(rise / width));
      EXPECT_LT(to_arcsec(std::abs(c.at(k, w).bending_rad + f * rise - ray.bending_rad)) / stretch,
                2 * tolerance_arcsec)
          << to_deg(e);
      ++compared;
    }
  }
  EXPECT_GT(compared, 150);
}

TEST_P(TransferCurves, JumpsAreWhereTheRaysSay) {
  // oracle: the same steps on both sides of every jump: the outcome, the number of turning points or the lowest or
  // highest
  //         point changes there by more than it does over the same width beside it
  // tolerance: 1e-9 rad, the bracket's width with what two tables differ by
  const TransferCurve c = curve();
  const IndexTable t = table();
  int jumps = 0;
  for (std::size_t k = 0; k + 1 < c.elevation_rad.size(); ++k)
    for (std::size_t w = 0; w < 2; ++w) {
      if (c.joined(k, w)) continue;
      EXPECT_LT(c.elevation_rad[k + 1] - c.elevation_rad[k], 3e-10);
      const double at = 0.5 * (c.elevation_rad[k] + c.elevation_rad[k + 1]);
      const f64::RayEnd below = stepped(t, w, at - 1e-7), above = stepped(t, w, at + 1e-7);
      const bool reach = std::abs(below.min_z_m - above.min_z_m) + std::abs(below.max_z_m - above.max_z_m) > 1e-3;
      EXPECT_TRUE(below.outcome != above.outcome || below.turning_points != above.turning_points || reach)
          << to_deg(at) << " deg, wavelength " << w;
      ++jumps;
    }
  EXPECT_GT(jumps, 0);  // each of these eyes has a horizon at least
}

TEST_P(TransferCurves, ImagesAreAllThereAndNoMore) {
  // oracle: for ten true altitudes, changes of sign of a(e) - a0 along 20000 rays by steps; each image found is traced
  // tolerance: the count exactly, unless a fold lies within 1 arcsec of the altitude; the image to 0.05 arcsec over
  //            max(1, |dR/da|)
  const TransferCurve c = curve();
  const IndexTable t = build_index_table(air(), {450}, IndexTableOptions{false, 1e-3, GetParam().height_m});
  constexpr int scan = 4000;
  std::vector<f64::RayEnd> rays;
  std::vector<double> elevations;
  for (int i = 0; i <= scan; ++i) {
    elevations.push_back(c.elevation_rad.front() + (c.elevation_rad.back() - c.elevation_rad.front()) * i / scan);
    rays.push_back(stepped(t, 0, elevations.back()));
  }
  for (int i = 0; i < 10; ++i) {
    const double wanted = to_rad(GetParam().low_deg + 0.1 + 0.15 * i);
    int seen = 0;
    for (int k = 0; k < scan; ++k) {
      const auto &a = rays[static_cast<std::size_t>(k)], &b = rays[static_cast<std::size_t>(k + 1)];
      if (a.outcome != f64::RAY_SPACE || b.outcome != f64::RAY_SPACE) continue;
      const double from = elevations[static_cast<std::size_t>(k)] - a.bending_rad - wanted;
      const double to = elevations[static_cast<std::size_t>(k + 1)] - b.bending_rad - wanted;
      seen += (from <= 0) != (to <= 0) && std::abs(to - from) < to_rad(0.5);
    }
    const std::vector<Image> images = images_of(c, 0, wanted);
    // The scan misses images in the steep approach to a jump, which the curve brackets: never fewer, each one real.
    EXPECT_GE(static_cast<int>(images.size()), seen) << to_deg(wanted);
    for (const Image &image : images) {
      const f64::RayEnd ray = stepped(t, 0, to_rad(image.apparent_altitude_deg));
      const double miss = std::abs(to_rad(image.apparent_altitude_deg) - ray.bending_rad - wanted);
      EXPECT_LT(to_arcsec(miss) * std::min(1.0, image.magnification), 0.05) << image.apparent_altitude_deg;
    }
  }
}

std::string name_of(const ::testing::TestParamInfo<Air> &one) {
  return std::string(one.param.profile) + "_" + std::to_string(static_cast<int>(one.param.height_m)) + "m";
}
INSTANTIATE_TEST_SUITE_P(Airs, TransferCurves, ::testing::ValuesIn(airs), name_of);

TEST(TransferFile, ReadsBackWhatWasWritten) {
  // oracle: the curve itself; text and back
  // tolerance: none for elevations' degrees and flags; 1e-12 relative for angles that go through another unit
  SkyRayOptions options;
  options.height_m = 45;
  options.precision = Precision::double_;
  SkyRays rays(reference_profile("duct_10K"), {450, 650}, options, shared_device());
  TransferCurve curve = trace_transfer_curve(rays, -0.01, 0.01, 0.1);
  curve.profile = "duct_10K", curve.zenith_column_kg_m2 = 10000;
  const auto path = std::filesystem::temp_directory_path() / "greenray_transfer_test.csv";
  std::ofstream(path) << as_csv(curve);
  const TransferCurve back = read_transfer_curve(path);
  EXPECT_EQ(back.profile, curve.profile);
  EXPECT_EQ(back.height_m, 45);
  EXPECT_EQ(back.wavelength_nm, curve.wavelength_nm);
  EXPECT_EQ(back.joined_to_next, curve.joined_to_next);
  ASSERT_EQ(back.rays.size(), curve.rays.size());
  for (std::size_t i = 0; i < curve.rays.size(); ++i) {
    EXPECT_EQ(back.rays[i].outcome, curve.rays[i].outcome);
    if (curve.rays[i].outcome == f64::RAY_TRAPPED) continue;
    EXPECT_NEAR(back.rays[i].bending_rad, curve.rays[i].bending_rad, 1e-12 * std::abs(curve.rays[i].bending_rad));
    EXPECT_NEAR(back.rays[i].column[0], curve.rays[i].column[0], 1e-12 * curve.rays[i].column[0]);
  }
  std::filesystem::remove(path);
}

TEST(TransferFile, BadTablesGiveOneErrorWithItsPlace) {
  // oracle: the format as docs/file-formats.md states it; line and column counted by hand
  const std::string first = "# greenray transfer curve 1\n# height_m 2\n# zenith_column_kg_m2 10000\n";
  const std::string header =
      "apparent_altitude_deg,wavelength_nm,status,refraction_arcsec,true_altitude_deg,air_mass,min_height_m,"
      "ground_distance_m,joined_to_next\n";
  const std::string row = "0,550,space,2000,-0.5,38,2,1e6,1\n";
  struct Bad {
    std::string text;
    int line, column;
  };
  const std::vector<Bad> all{{"hello\n", 1, 1},
                             {first + "altitude\n", 4, 1},
                             {first + header + "0,550,spice,1,1,1,1,1,1\n", 5, 7},
                             {first + header + "0,550,space,abc,1,1,1,1,1\n", 5, 13},
                             {first + header + row + "-1,550,space,2000,-0.5,38,2,1e6,1\n", 6, 1},
                             {first + header + row + "1,650,space,2000,-0.5,38,2,1e6,1\n", 6, 3},
                             {first + header + row + "1,550,space\n", 6, 1},
                             {first + header + "0,550,space,2000,-0.5,38,2,1e6,7\n", 5, 32},
                             {first + header + row, 5, 1}};
  const auto path = std::filesystem::temp_directory_path() / "greenray_bad_transfer_test.csv";
  for (const Bad &bad : all) {
    std::ofstream(path) << bad.text;
    try {
      (void)read_transfer_curve(path);
      ADD_FAILURE() << "read: " << bad.text;
    } catch (const InputError &error) {
      const std::string place = path.string() + ":" + std::to_string(bad.line) + ":" + std::to_string(bad.column) + ":";
      EXPECT_NE(std::string(error.what()).find(place), std::string::npos) << error.what() << " expected " << place;
    }
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace greenray
