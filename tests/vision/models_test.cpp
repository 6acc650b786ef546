// The laws of the bleaching models, the disk that bleaches as one, light around the picture, and what counts as
// greener.
#include <gtest/gtest.h>

#include <cmath>

#include "image/colour.hpp"
#include "image/picture_sink.hpp"
#include "image/picture_source.hpp"
#include "vision/greener.hpp"
#include "vision/human_eye.hpp"
#include "vision/retina.hpp"
#include "vision/retinal_light.hpp"

namespace greenray::vision {
namespace {

/// One pixel through bleach_rows with the same pigment left everywhere.
struct Bleached {
  Lms lms;
  double y, luminance;
};

Bleached bleached(const BleachingOptions &options, const Lms &lms, const std::array<float, 3> &u,
                  const std::vector<SelfScreening> &screening = {}) {
  Retina retina;
  retina.options = options;
  retina.options.exposure = BleachingOptions::Exposure::seconds;
  retina.shared = u;
  retina.pool = {0.25F, 0.36F, 0.81F};
  const auto xyz = xyz_from_lms(lms);
  float x = static_cast<float>(xyz[0]), y = static_cast<float>(xyz[1]), z = static_cast<float>(xyz[2]), luminance = 7;
  float left[3];
  bleach_rows(retina, 1, &x, &y, &z, &luminance, {left, left + 1, left + 2}, screening);
  return {lms_from_xyz({static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)}),
          static_cast<double>(y), static_cast<double>(luminance)};
}

RgbImage filled(int width, int height, float level) {
  return {width, height, std::vector<float>(3 * static_cast<std::size_t>(width * height), level)};
}

EyeReport look(HumanEye &eye, const RgbImage &image, double fov_deg) {
  RgbImage picture;
  const auto source = picture_source(image, fov_deg);
  const auto sink = memory_sink(picture, image.width, image.height);
  return eye.develop(*source, *sink);
}

}  // namespace

// oracle: the law of each model, cone by cone: u; 10^(-3 (1 - u)); u / pool^k; and the luminance kept or let fall with
// Y tolerance: 2e-6: floats, and the difference of X and Y that gives M
TEST(BleachModels, GainsFollowTheirLaws) {
  const Lms light{3, 2, 1};
  const std::array<float, 3> u{0.5F, 0.8F, 0.9F};
  const double pool[3] = {0.25, 0.36, 0.81};
  for (const double neural : {0.0, 0.5, 1.0})
    for (const BleachModel model : {BleachModel::catch_, BleachModel::threshold, BleachModel::adapted}) {
      Lms expected = light;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto left = static_cast<double>(u[k]);
        expected[k] *= model == BleachModel::threshold ? std::pow(10, -3 * (1 - left))
                       : model == BleachModel::adapted ? left / std::pow(pool[k], neural)
                                                       : left;
      }
      BleachingOptions options;
      options.model = model;
      options.neural = neural;
      options.dims = true;
      const Bleached falls = bleached(options, light, u);
      options.dims = false;
      const Bleached kept = bleached(options, light, u);
      const double before = xyz_from_lms(light)[1], after = xyz_from_lms(expected)[1];
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(falls.lms[k], expected[k], 6e-6);
        EXPECT_NEAR(kept.lms[k], expected[k] * before / after, 6e-6 * before / after);
      }
      EXPECT_NEAR(falls.luminance, 7 * after / before, 1e-5);
      EXPECT_EQ(kept.luminance, 7);
      EXPECT_NEAR(kept.y, before, 1e-6);
    }
}

// oracle: the catch of the bleached pigment itself, integrated over the spectrum: (1 - 10^(-D u A)) in place of u times
// the
//         whole.  tolerance: 1 %: a parabola through u = 0, 1/2 and 1
TEST(BleachModels, ShapeIsTheCatchOfThinnerPigment) {
  Spectrum light;
  std::vector<float> radiance;
  for (double nm = 390; nm <= 780; nm += 5) {
    light.wavelength_nm.push_back(nm);
    light.radiance.push_back(std::exp((nm - 600) / 100));
    radiance.push_back(static_cast<float>(light.radiance.back()));
  }
  const SelfScreening screening = SpectralScreening(light.wavelength_nm).of(radiance.data(), 1);
  BleachingOptions options;
  options.model = BleachModel::shape;
  options.dims = true;
  const Lms whole = cone_catches(light);
  for (const double u : {0.05, 0.25, 0.5, 0.75}) {
    const auto left = static_cast<float>(u);
    const Bleached seen = bleached(options, {1, 1, 1}, {left, left, left}, {screening});
    const Lms thin = cone_catches(light, {u, u, u});
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(seen.lms[k] / (thin[k] / whole[k]), 1, 0.01) << u << " cone " << k;
    EXPECT_GT(thin[0] / whole[0], 1.02 * u) << "less pigment screens itself less";
  }
}

// oracle: two looks of 1 s at a disk that bleaches as one are a look of 2 s.  tolerance: float
TEST(BleachModels, TheDiskKeepsItsPigmentFromPictureToPicture) {
  EyeOptions options;
  options.bleaching.exposure = BleachingOptions::Exposure::seconds;
  options.bleaching.seconds = 1;
  options.bleaching.pooled = true;
  options.carry_state = true;
  RgbImage disk = filled(40, 30, 10);
  for (std::size_t i = 600; i < 620; ++i) disk.set_pixel(i, {4e5, 1e5, 1e3});
  HumanEye twice(options);
  const EyeReport first = look(twice, disk, 1), second = look(twice, disk, 1);
  options.bleaching.seconds = 2;
  HumanEye once(options);
  const EyeReport whole = look(once, disk, 1);
  EXPECT_LT(whole.pool_unbleached[0], first.pool_unbleached[0] - 0.05);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(second.pool_unbleached[k], whole.pool_unbleached[k], 1e-6);
}

// oracle: the pupil's field is 60 square degrees, of which the picture is a share and the surround the rest; light
// around
//         a picture scatters into it.  tolerance: float
TEST(Surround, CountsForThePupilAndScattersIntoThePicture) {
  EyeOptions options;
  options.surround_cd_m2 = 4000;
  HumanEye eye(options);
  const RgbImage grey = filled(64, 64, 100);
  const double area_deg2 = view_geometry(64, 64, 3.0, 1).area_deg2();
  EXPECT_NEAR(area_deg2, 9, 0.01);
  const EyeReport report = look(eye, grey, 3);
  EXPECT_NEAR(report.field_cd_m2, (100 * area_deg2 + 4000 * (60 - area_deg2)) / 60, 1e-3);
  const auto source = picture_source(grey, 3);
  for (const double around : {0.0, 100.0, 4000.0}) {
    LightStore store(*source, 1U << 30U);
    const RetinalLight light({true, {}, around, 1}, view_geometry(64, 64, 3.0, 1), source->facts(), store, 4096);
    const Plane &cells = light.luminance_cells();
    const double middle = static_cast<double>(cells.row(32)[32]);
    if (around > 100) EXPECT_GT(middle, 110);
    else if (around < 100) EXPECT_LT(middle, 99);
    else EXPECT_NEAR(middle, 100, 1e-3);
  }
}

// oracle: a telescope of 20 shows a field of 1 degree as one of 20.  tolerance: rounding
TEST(View, IsMagnified) {
  const ViewGeometry view = view_geometry(100, 50, 1.0, 20);
  EXPECT_NEAR(view.fov_deg, 20, 1e-12);
  EXPECT_NEAR(view.half_width, std::tan(10 * M_PI / 180), 1e-12);
  EXPECT_NEAR(view.half_height, view.half_width / 2, 1e-12);
  EXPECT_THROW(view_geometry(100, 50, 10.0, 20), std::domain_error);
}

// oracle: what the words mean: yellow that turns to green is greener, the way back is not, nor is a green that turns
// blue tolerance: none
TEST(Greener, IsTowardsGreen) {
  const float yellow[3] = {0.8F, 0.7F, 0.1F}, green[3] = {0.5F, 0.8F, 0.1F}, blue[3] = {0.1F, 0.2F, 0.9F};
  float overlay[3], map[2];
  EXPECT_EQ(compare_rows(1, yellow, green, overlay, map).pixels, 1U);
  EXPECT_GT(map[0], 10) << "hue shift towards green [deg]";
  EXPECT_GT(map[1], 5);
  EXPECT_EQ(compare_rows(1, green, yellow, overlay, map).pixels, 0U);
  EXPECT_LT(map[0], -10);
  EXPECT_EQ(compare_rows(1, green, blue, overlay, map).pixels, 0U);
  EXPECT_EQ(compare_rows(1, blue, green, overlay, map).pixels, 1U);
  EXPECT_EQ(compare_rows(1, yellow, yellow, overlay, map).changed, 0U);
}

}  // namespace greenray::vision
