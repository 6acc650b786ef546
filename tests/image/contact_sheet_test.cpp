// Contact sheets: light is kept, pictures are where they belong.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "image/colour.hpp"
#include "image/contact_sheet.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;

Raster checkers(int width, int height, int bits, std::uint16_t dark, std::uint16_t bright) {
  Raster raster{width, height, bits, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) raster.rgb.push_back((x + y) % 2 ? bright : dark);
  return raster;
}

class Sheet : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
  fs::path put(const std::string &name, const Raster &raster) const {
    write_png(folder / name, raster);
    return folder / name;
  }
  fs::path folder = fs::temp_directory_path() / ("greenray-sheet-" + std::to_string(::getpid()));
};

// oracle: half the pixels black and half white give half the light, the sRGB level 188 (187.5 by IEC 61966-2-1), which
// a
//         mean of levels (128) would miss; thumbnails of 800x600 on a sheet 402 wide are a quarter and smaller
// tolerance: one level, of rounding
TEST_F(Sheet, KeepsLightAndOrder) {
  const Raster grey = checkers(800, 600, 8, 0, 255);
  const Raster black = checkers(800, 600, 16, 0, 0), white = checkers(600, 800, 16, 65535, 65535);
  const Raster sheet = contact_sheet({put("a.png", grey), put("b.png", black), put("c.png", white)}, 402);
  EXPECT_EQ(sheet.bits, 8);
  EXPECT_EQ(sheet.width, 402);
  EXPECT_EQ(sheet.height, 302);
  const auto at = [&](int x, int y) {
    return static_cast<int>(sheet.rgb[3 * static_cast<std::size_t>(y * sheet.width + x)]);
  };
  EXPECT_NEAR(at(100, 75), 255 * srgb_encode(0.5), 1);
  EXPECT_EQ(at(300, 75), 0);
  EXPECT_EQ(at(50, 230), 255);
  EXPECT_EQ(at(180, 230), 0) << "a tall picture fills its cell's height only";
}

// oracle: what is smaller than a cell stays as it is.  tolerance: none
TEST_F(Sheet, EnlargesNothing) {
  const Raster small = checkers(5, 3, 8, 10, 200);
  const Raster sheet = contact_sheet({put("a.png", small)});
  EXPECT_EQ(sheet.width, 5);
  EXPECT_EQ(sheet.height, 3);
  EXPECT_EQ(sheet.rgb, small.rgb);
  EXPECT_THROW(contact_sheet({}), std::invalid_argument);
}

}  // namespace
}  // namespace greenray
