// Pictures of other writers, row by row: primaries, white luminance, X Y Z, Y alone.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <string>

#include "image/picture_source.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;

class Sources : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path path() const { return folder_ / "a.exr"; }

  /// One pixel; chromaticities of Display P3 if wanted.
  void write(const std::string &channels, const std::array<float, 3> &values, float white_cd_m2, bool p3) const {
    Imf::Header header(1, 1);
    if (white_cd_m2 > 0) Imf::addWhiteLuminance(header, white_cd_m2);
    if (p3)
      Imf::addChromaticities(header, Imf::Chromaticities(Imath::V2f(0.68F, 0.32F), Imath::V2f(0.265F, 0.69F),
                                                         Imath::V2f(0.15F, 0.06F), Imath::V2f(0.3127F, 0.329F)));
    Imf::FrameBuffer frame;
    std::array<float, 3> pixel = values;
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const std::string name(1, channels[c]);
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      frame.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char *>(&pixel[c]), sizeof(float), sizeof(float)));
    }
    Imf::OutputFile file(path().c_str(), header);
    file.setFrameBuffer(frame);
    file.writePixels(1);
  }

  std::vector<float> xyz(const SourceOptions &options = {}) const {
    std::vector<float> planes;
    open_picture(path(), options)->read(0, 1, planes);
    return planes;
  }

 private:
  fs::path folder_ = fs::temp_directory_path() / ("greenray-sources-" + std::to_string(::getpid()));
};

}  // namespace

// oracle: SMPTE RP 431 / Display P3 to XYZ, published to six digits (0.486571 0.265668 0.198217; 0.228975 0.691739
// 0.079287;
//         0 0.045113 1.043944); Rec. 709 luminance 0.2126 0.7152 0.0722.  tolerance: 2e-6 of the digits
TEST_F(Sources, PrimariesAndWhiteLuminance) {
  write("RGB", {1, 2, 3}, 250, true);
  const std::vector<float> p3 = xyz();
  EXPECT_NEAR(p3[0] / 250, 0.486571 + 2 * 0.265668 + 3 * 0.198217, 1e-5);
  EXPECT_NEAR(p3[1] / 250, 0.228975 + 2 * 0.691739 + 3 * 0.079287, 1e-5);
  EXPECT_NEAR(p3[2] / 250, 2 * 0.045113 + 3 * 1.043944, 1e-5);
  EXPECT_NEAR(xyz({10.0, true, false})[1] / 10, p3[1] / 250, 1e-6) << "a unit that is given goes first";
  write("RGB", {1, 1, 1}, 0, false);
  EXPECT_NEAR(xyz()[1], 1, 1e-6);
  EXPECT_FALSE(open_picture(path())->facts().absolute);
  write("RGB", {0, 1, 0}, 80, false);
  EXPECT_NEAR(xyz()[1], 80 * 0.7152, 1e-2);
  EXPECT_TRUE(open_picture(path())->facts().absolute);
}

// oracle: X Y Z are colours themselves; Y alone is a grey as white as the screen's; nothing else is a picture
// tolerance: float
TEST_F(Sources, ColoursWithoutPrimaries) {
  write("XYZ", {0.3F, 0.5F, 0.2F}, 100, false);
  EXPECT_NEAR(xyz()[0], 30, 1e-5);
  EXPECT_NEAR(xyz()[1], 50, 1e-5);
  EXPECT_NEAR(xyz()[2], 20, 1e-5);
  write("Y", {0.5F, 0, 0}, 100, false);
  EXPECT_NEAR(xyz()[0], 50 * 0.3127 / 0.3290, 1e-4);
  EXPECT_NEAR(xyz()[1], 50, 1e-5);
  write("RG", {1, 1, 0}, 100, false);
  EXPECT_THROW(open_picture(path()), InputError);
}

// oracle: a picture in Rec. 709 stays as it is, to the bit, where that is asked for; others become it.  tolerance:
// none;
//         float
TEST_F(Sources, Rec709StaysRec709) {
  write("RGB", {0.1F, 1e5F, -0.3F}, 1, false);
  const auto same = open_picture(path(), {std::nullopt, true, true});
  EXPECT_TRUE(same->facts().rec709);
  EXPECT_EQ(read_rgb(*same).rgb, (std::vector<float>{0.1F, 1e5F, -0.3F}));
  write("RGB", {1, 1, 1}, 1, true);
  const auto other = open_picture(path(), {std::nullopt, true, true});
  EXPECT_FALSE(other->facts().rec709);
  for (const float value : read_rgb(*other).rgb) EXPECT_NEAR(value, 1, 1e-5F);
}

}  // namespace greenray
