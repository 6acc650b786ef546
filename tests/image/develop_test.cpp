// PNG files and the camera view.
#include "image/develop.hpp"

#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>

#include "image/colour.hpp"
#include "support/error.hpp"

namespace greenray {
namespace fs = std::filesystem;

namespace {

fs::path scratch(const std::string &name) {
  return fs::temp_directory_path() / ("greenray-png-" + std::to_string(getpid()) + name);
}

/// A flattened low Sun with green upper and red lower rim over a dim sky; radiance from black-body-like factors.
RgbImage low_sun(int width, int height, double disk_cd_m2) {
  RgbImage image{width, height,
                 std::vector<float>(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
  const double radius = 0.3 * height, squash = 0.82;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      Rgb sum{0, 0, 0};
      const double shift[3] = {1.6, 0.0, -1.6};  // dispersion lifts blue and green, drops red [pixels]
      const double colour[3] = {1.0, 0.62, 0.10};
      for (std::size_t c = 0; c < 3; ++c) {
        const double dx = (x - 0.5 * width) / radius;
        const double dy = (y - 0.45 * height - shift[c]) / (radius * squash);
        const double r = std::hypot(dx, dy);
        const double redden = std::exp(-(0.4 + 0.5 * static_cast<double>(c)) * (dy + 1));
        if (r < 1) sum[c] += disk_cd_m2 * colour[c] * redden * (0.4 + 0.6 * std::sqrt(1 - r * r));
        sum[c] += disk_cd_m2 / 1500 * (0.8 + 0.2 * colour[c]) * std::exp(-0.8 * r) * (c == 2 ? 0.5 : 1.0);
      }
      if (y > 0.88 * height)
        for (double &channel : sum) channel = disk_cd_m2 / 40000;
      image.set_pixel(static_cast<std::size_t>(y * width + x), sum);
    }
  return image;
}

}  // namespace

// oracle: libpng's simplified reader, another code path than ours.  tolerance: none
TEST(Png, DecodesToWhatWasWritten) {
  const fs::path path = scratch("a.png");
  const Raster raster{2, 2, 8, {0, 1, 2, 253, 254, 255, 10, 20, 30, 128, 127, 126}};
  write_png(path, raster);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_file(&image, path.c_str()));
  image.format = PNG_FORMAT_RGB;
  std::vector<unsigned char> bytes(PNG_IMAGE_SIZE(image));
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr));
  EXPECT_EQ(std::vector<std::uint16_t>(bytes.begin(), bytes.end()), raster.rgb);
  EXPECT_EQ(read_png(path).rgb, raster.rgb);
  std::ifstream in(path, std::ios::binary);
  const std::string file{std::istreambuf_iterator<char>(in), {}};
  for (const char *chunk : {"sRGB", "gAMA", "cHRM"}) EXPECT_NE(file.find(chunk), std::string::npos) << chunk;
  const Raster deep{1, 2, 16, {0, 1, 258, 65535, 40000, 255}};
  write_png(path, deep);
  EXPECT_EQ(read_png(path).rgb, deep.rgb);
  EXPECT_EQ(read_png(path).bits, 16);
  write_file_atomically(path, file.substr(0, file.size() / 2));
  EXPECT_THROW(read_png(path), InputError);
  write_file_atomically(path, "no picture");
  EXPECT_THROW(read_png(path), InputError);
  fs::remove(path);
  EXPECT_THROW(read_png(path), InputError);
}

// oracle: the mean of dithered pixels is the undithered level; triangular noise of +-1 step has variance 1/6, rounding
//         after it brings the total to 1/4 whatever the level.  tolerance: 5 sigma of 60000 samples
TEST(Png, DitherKeepsTheMeanAndHasFixedSeed) {
  RgbImage flat{200, 100, std::vector<float>(60000, static_cast<float>(srgb_decode(100.3 / 255)))};
  const Raster raster = quantise(flat);
  double mean = 0, variance = 0;
  for (const std::uint16_t level : raster.rgb) {
    mean += level / 60000.0;
    variance += (level - 100.3) * (level - 100.3) / 60000.0;
    EXPECT_LE(std::abs(level - 100.3), 1.5);
  }
  EXPECT_NEAR(mean, 100.3, 5 * 0.5 / std::sqrt(60000.0));
  EXPECT_NEAR(variance, 0.25, 0.01);
  EXPECT_EQ(raster.rgb, quantise(flat).rgb);
  const RgbImage ends{1, 1, {-1.0F, 2.0F, std::numeric_limits<float>::quiet_NaN()}};
  EXPECT_EQ(quantise(ends).rgb, (std::vector<std::uint16_t>{0, 255, 0}));
  EXPECT_EQ(quantise(ends, 16).rgb, (std::vector<std::uint16_t>{0, 65535, 0}));
}

// oracle: what the camera view promises: red stays redder than green than blue across the disk, the top rim is green,
//         the sky ten stops down is visible, for any absolute brightness.  tolerance: one code value
TEST(Camera, LowSunKeepsItsColours) {
  CameraReport report;
  const RgbImage bright = camera_display(low_sun(240, 180, 1e9), {}, report);
  const RgbImage dim = camera_display(low_sun(240, 180, 1e4), {}, report);
  for (std::size_t i = 0; i < bright.rgb.size(); ++i) EXPECT_NEAR(bright.rgb[i], dim.rgb[i], 1e-4F);
  const auto at = [&](int x, int y) { return bright.pixel(static_cast<std::size_t>(y * 240 + x)); };
  const Rgb centre = at(120, 81);
  EXPECT_GT(srgb_encode(centre[0]), 0.8);
  EXPECT_GT(centre[0], 1.2 * centre[1]);
  EXPECT_GT(centre[1], 2 * centre[2]);
  EXPECT_LT(srgb_encode(centre[2]), 0.7);
  bool green_rim = false, red_rim = false;
  for (int y = 30; y < 140; ++y) {
    const Rgb rim = at(120, y);
    green_rim = green_rim || (y < 60 && rim[1] > 1.5 * rim[0] && rim[1] > rim[2]);
    red_rim = red_rim || (y > 100 && rim[0] > 4 * rim[1]);
  }
  EXPECT_TRUE(green_rim);
  EXPECT_TRUE(red_rim);
  RgbImage ten_stops{100, 1, std::vector<float>(300, 1024.0F)};
  for (std::size_t c = 0; c < 3; ++c) ten_stops.rgb[c] = 1.0F;
  EXPECT_GT(255 * srgb_encode(luminance(camera_display(ten_stops, {}, report).pixel(0))), 25);
}

// oracle: rules of the header.  tolerance: none
TEST(Camera, HopelessInputIsBlackAndCounted) {
  RgbImage image{4, 1, {1, 1, 1, NAN, 1, 1, INFINITY, 1, 1, -5, -5, -5}};
  const CameraPicture picture = develop_camera(image);
  EXPECT_EQ(picture.report.replaced, 3U);
  EXPECT_GT(picture.pixels.rgb[0], 200);
  for (std::size_t i = 3; i < 12; ++i) EXPECT_EQ(picture.pixels.rgb[i], 0);
  const CameraPicture black = develop_camera(RgbImage{2, 2, std::vector<float>(12, 0.0F)});
  for (const std::uint16_t level : black.pixels.rgb) EXPECT_EQ(level, 0);
  EXPECT_EQ(black.report.replaced, 0U);
  RgbImage green{1, 1, {-0.3F, 1.0F, 0.1F}};  // spectral green, outside sRGB
  EXPECT_EQ(develop_camera(green).report.gamut_moved, 1U);
  EXPECT_EQ(develop_camera(green).report.replaced, 0U);
}

// oracle: the definition: geometric mean of the 99.5 % and 99.98 % points of the sorted strongest channels, whatever
// the
//         pieces.  tolerance: rounding of a product
TEST(Camera, KeyOfPiecesIsThatOfTheWhole) {
  const RgbImage scene = low_sun(200, 150, 3e7);
  std::vector<float> strongest;
  for (std::size_t i = 0; i < scene.pixels(); ++i) {
    const Rgb value = scene.pixel(i);
    const double most = std::max({value[0], value[1], value[2]});
    if (most > 0) strongest.push_back(static_cast<float>(most));
  }
  std::sort(strongest.begin(), strongest.end());
  const auto point = [&](double share) {
    return static_cast<double>(strongest[static_cast<std::size_t>(share * static_cast<double>(strongest.size() - 1))]);
  };
  for (const std::size_t piece : {scene.pixels(), std::size_t{7 * 200}, std::size_t{33}}) {
    ExposureKey key;
    do
      for (std::size_t from = 0; from < scene.pixels(); from += piece)
        key.look(scene.rgb.data() + 3 * from, std::min(piece, scene.pixels() - from));
    while (key.again());
    EXPECT_NEAR(key.cd_m2() / std::sqrt(point(0.995) * point(0.9998)), 1, 1e-14) << piece;
  }
}

// oracle: one stop is a factor of two of scene light.  tolerance: rounding to float
TEST(Camera, OneStopIsAFactorOfTwo) {
  RgbImage scene = low_sun(60, 45, 1e6), doubled = scene;
  for (float &value : doubled.rgb) value *= 2;
  CameraReport report, stop;
  report.key_cd_m2 = stop.key_cd_m2 = 1e6;
  std::vector<float> bright(scene.rgb.size()), exposed(scene.rgb.size());
  camera_rows({std::nullopt, 8, true}, report, doubled.rgb.data(), scene.pixels(), bright.data());
  camera_rows({1.0, 8, true}, stop, scene.rgb.data(), scene.pixels(), exposed.data());
  for (std::size_t i = 0; i < bright.size(); ++i) ASSERT_NEAR(bright[i], exposed[i], 1e-6F);
}

}  // namespace greenray
