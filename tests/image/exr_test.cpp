// EXR files, written by us and read back by OpenEXR itself.
#include "image/exr.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "image/colour.hpp"
#include "image/compare.hpp"
#include "image/picture_source.hpp"
#include "support/error.hpp"

namespace greenray {
namespace fs = std::filesystem;

class ExrTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto *info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder = fs::temp_directory_path() / ("greenray-exr-" + std::string(info->name()) + std::to_string(getpid()));
    fs::create_directories(folder);
    path = folder / "x.exr";
  }
  void TearDown() override { fs::remove_all(folder); }

  static SpectralImage sample(int width = 7, int height = 5) {
    SpectralImage image;
    image.width = width;
    image.height = height;
    image.wavelength_nm = {450.125, 550, 999.5, 1000.25};  // names do not sort like numbers
    for (std::size_t i = 0; i < image.pixels() * 4; ++i)
      image.radiance.push_back(static_cast<float>(1e-3 * std::exp(0.37 * static_cast<double>(i % 71))));
    for (const char *name : {"variance", "true_altitude_deg"})
      for (std::size_t i = 0; i < image.pixels(); ++i)
        image.channels[name].push_back(static_cast<float>(i) * (name[0] == 'v' ? 1e-9F : -0.1F));
    return image;
  }

  static std::string input_error(const fs::path &file) {
    try {
      read_exr(file);
    } catch (const InputError &error) {
      return error.what();
    }
    return "";
  }

  fs::path folder, path;
};

// oracle: the values written.  tolerance: none, FLOAT channels and lossless ZIP
TEST_F(ExrTest, RoundTripIsExact) {
  const SpectralImage image = sample();
  const std::string scene(5000, 's');
  EXPECT_EQ(write_exr(path, image, {{"scene", scene}, {"fov_deg", 0.8}, {"a_name_longer_than_31_characters_x", 1.0}})
                .not_finite_replaced,
            0U);
  const ExrPicture picture = read_exr(path);
  ASSERT_EQ(picture.parts.size(), 3U);
  EXPECT_EQ(picture.parts[1].name, "true_altitude_deg");
  const SpectralImage back = picture.spectral();
  EXPECT_EQ(back.wavelength_nm, image.wavelength_nm);
  EXPECT_EQ(back.radiance, image.radiance);
  EXPECT_EQ(back.channels, image.channels);
  EXPECT_EQ(picture.rgb().rgb, rgb_from_spectral(image).rgb);
  EXPECT_EQ(picture.white_luminance_cd_m2, 1.0);
  EXPECT_EQ(std::get<std::string>(picture.attributes.at("scene")), scene);
  EXPECT_EQ(std::get<double>(picture.attributes.at("fov_deg")), 0.8);
  EXPECT_EQ(std::get<std::string>(picture.attributes.at("emissiveUnits")), "W.m^-2.sr^-1");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
}

// oracle: OpenEXR's plain single-part reader and the channel names of Fichet et al. 2021.  tolerance: none
TEST_F(ExrTest, OtherProgramsReadIt) {
  const SpectralImage image = sample();
  write_exr(path, image);
  Imf::InputFile input(path.c_str());
  const Imf::Header &header = input.header();
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("spectralLayoutVersion").value(), "1.0");
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("emissiveUnits").value(), "W.m^-2.sr^-1");
  EXPECT_EQ(Imf::whiteLuminance(header), 1.0F);
  EXPECT_EQ(Imf::chromaticities(header).white, Imath::V2f(0.3127F, 0.3290F));
  ASSERT_NE(header.channels().findChannel("S0.550,000000nm"), nullptr);
  ASSERT_NE(header.channels().findChannel("S0.450,125000nm"), nullptr);
  EXPECT_EQ(header.channels().findChannel("S0.550,000000nm")->type, Imf::FLOAT);
  std::vector<float> green(image.pixels());
  Imf::FrameBuffer frame;
  frame.insert("S0.550,000000nm", Imf::Slice::Make(Imf::FLOAT, green.data(), header.dataWindow()));
  input.setFrameBuffer(frame);
  input.readPixels(0, image.height - 1);
  for (std::size_t p = 0; p < image.pixels(); ++p) EXPECT_EQ(green[p], image.radiance[4 * p + 1]);
}

// oracle: a file of HALF X,Y,Z and a foreign header made with OpenEXR alone.  tolerance: 11 bits of HALF
TEST_F(ExrTest, ReadsForeignFiles) {
  {
    Imf::Header header(2, 1);
    Imf::addWhiteLuminance(header, 50.0F);
    for (const char *name : {"X", "Y", "Z"}) header.channels().insert(name, Imf::Channel(Imf::HALF));
    Imf::OutputFile output(path.c_str(), header);
    const Xyz white = xyz_from_rgb({1, 1, 1});
    half pixels[2][3];
    for (std::size_t c = 0; c < 3; ++c) pixels[0][c] = pixels[1][c] = half(static_cast<float>(2 * white[c]));
    Imf::FrameBuffer frame;
    const char *names[3] = {"X", "Y", "Z"};
    for (int c = 0; c < 3; ++c)
      frame.insert(names[c], Imf::Slice(Imf::HALF, reinterpret_cast<char *>(&pixels[0][c]), 6, 12));
    output.setFrameBuffer(frame);
    output.writePixels(1);
  }
  const RgbImage rgb = read_exr(path).rgb();
  for (const float channel : rgb.rgb) EXPECT_NEAR(channel, 100.0F, 0.2F);
  EXPECT_EQ(spectral_channel_wavelength_nm("S0.550.5nm"), 550.5);
  EXPECT_EQ(spectral_channel_wavelength_nm("S0.5,5e-1um"), 550.0);
  EXPECT_NEAR(*spectral_channel_wavelength_nm("S0.500THz"), 599.584916, 1e-6);
  for (const char *name : {"R", "S1.550,0nm", "S0.nm", "S0.5x", "T.550,0nm"})
    EXPECT_FALSE(spectral_channel_wavelength_nm(name)) << name;
}

// oracle: rule stated in the header: NaN and infinite radiance become 0 and are counted.  tolerance: none
TEST_F(ExrTest, NeverWritesInfinity) {
  SpectralImage image = sample();
  image.radiance[3] = std::numeric_limits<float>::infinity();
  image.radiance[9] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(write_exr(path, image).not_finite_replaced, 2U);
  const SpectralImage back = read_exr(path).spectral();
  EXPECT_EQ(back.radiance[3], 0);
  EXPECT_EQ(back.radiance[9], 0);
  for (const float value : read_exr(path).rgb().rgb) EXPECT_TRUE(std::isfinite(value));
}

// oracle: the input broken on purpose.  tolerance: none
TEST_F(ExrTest, DamagedFilesAreRefused) {
  EXPECT_EQ(input_error(path), path.string() + ":1:1: expected an EXR file, found no such file");
  EXPECT_EQ(input_error(folder), folder.string() + ":1:1: expected an EXR file, found a folder or device");
  write_file_atomically(path, "");
  EXPECT_NE(input_error(path).find(":1:1: not a readable EXR file"), std::string::npos);
  write_exr(path, sample(64, 64));
  std::ifstream in(path, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  for (const double fraction : {0.001, 0.01, 0.05, 0.3, 0.7, 0.99}) {
    write_file_atomically(path,
                          whole.substr(0, static_cast<std::size_t>(fraction * static_cast<double>(whole.size()))));
    EXPECT_NE(input_error(path).find(path.string() + ":1:1: "), std::string::npos) << fraction;
  }
  for (std::size_t at = 0; at < whole.size(); at += 97) {  // any byte: read or refused, never a crash
    std::string wrong = whole;
    wrong[at] = static_cast<char>(wrong[at] ^ 0xFF);
    write_file_atomically(path, wrong);
    input_error(path);
  }
}

// oracle: interface: these are mistakes of the program, not of the user.  tolerance: none
TEST_F(ExrTest, RefusesWrongUse) {
  SpectralImage image = sample();
  EXPECT_THROW(write_exr(path, image, {{"compression", 1.0}}), std::invalid_argument);
  EXPECT_THROW(write_exr(path, image, {{"whiteLuminance", 1.0}}), std::invalid_argument);
  image.channels["variance"].pop_back();
  EXPECT_THROW(write_exr(path, image), std::invalid_argument);
  EXPECT_FALSE(fs::exists(path));
}

// oracle: RLIMIT_FSIZE refuses bytes at every possible moment: header, pixels, offsets written by OpenEXR's destructor
// tolerance: none
TEST_F(ExrTest, FullDiskAtAnyMoment) {
  const SpectralImage image = sample(64, 64);
  write_exr(path, image);
  const auto whole = static_cast<rlim_t>(fs::file_size(path));
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit normal{};
  getrlimit(RLIMIT_FSIZE, &normal);
  for (rlim_t limit = 0; limit < whole; limit += whole / 40) {
    write_file_atomically(folder / "old.exr", "old");
    const rlimit small{limit, normal.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    EXPECT_THROW(write_exr(folder / "old.exr", image), RunError) << limit;
    setrlimit(RLIMIT_FSIZE, &normal);
    EXPECT_EQ(fs::file_size(folder / "old.exr"), 3U);
  }
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 2);
}

// oracle: differences worked out by hand.  tolerance: rounding
TEST_F(ExrTest, Compare) {
  RgbImage a{2, 1, {1, 2, 3, 4, 5, 6}}, b = a;
  ImageDifference same = compare_images(a, b);
  EXPECT_EQ(same.rms, 0);
  EXPECT_EQ(same.relative_rms, 0);
  EXPECT_TRUE(std::isinf(same.psnr_db));
  EXPECT_EQ(same.pixels, 2U);
  a.rgb[5] = 9;
  const ImageDifference three = compare_images(a, b);
  EXPECT_NEAR(three.rms, 3 / std::sqrt(6.0), 1e-14);
  EXPECT_EQ(three.max_abs, 3);
  EXPECT_NEAR(three.relative_rms, 3 / std::sqrt(91.0), 1e-14);
  EXPECT_NEAR(three.psnr_db, 20 * std::log10(6 / (3 / std::sqrt(6.0))), 1e-12);
  a.rgb[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(std::isinf(compare_images(a, b).rms));
  b.rgb[0] = a.rgb[0];
  EXPECT_EQ(compare_images(a, b).max_abs, 3);
  write_exr(path, sample(7, 5));
  write_exr(folder / "y.exr", sample(5, 7));
  EXPECT_EQ(compare_exr(path, path).rms, 0);
  try {
    compare_exr(path, folder / "y.exr");
    FAIL();
  } catch (const InputError &error) {
    EXPECT_EQ(error.what(), path.string() + ":1:1: expected a picture of 5x7 pixels like the reference, found 7x5");
  }
}

// oracle: what OpenEXR's C++ library was given to write, whatever the compression, line order, window or tiling; rows
// in
//         pieces of any size.  tolerance: none where the compression keeps floats, 5 % for the lossy ones
TEST_F(ExrTest, RowsOfEveryKindOfFile) {
  const int width = 67, height = 133;
  std::vector<float> values;
  for (int i = 0; i < width * height * 3; ++i) values.push_back(100 + 50 * std::sin(0.01F * static_cast<float>(i / 3)));
  const auto check = [&](double tolerance, const std::string &what) {
    const auto source = open_picture(path);
    for (const int rows : {133, 64, 7}) {
      std::vector<float> planes;
      for (int first = 0; first < height; first += rows) {
        const int some = std::min(rows, height - first);
        source->read(first, some, planes);
        for (int i = 0; i < some * width; ++i)
          ASSERT_NEAR(planes[static_cast<std::size_t>(i)] / values[static_cast<std::size_t>(3 * (first * width + i))],
                      1, tolerance + 1e-12)
              << what << ", row " << first + i / width;
      }
    }
  };
  const auto write = [&](Imf::Compression compression, Imf::LineOrder order, Imath::V2i corner, bool tiles) {
    Imf::Header header(Imath::Box2i({0, 0}, {width - 1, height - 1}),
                       Imath::Box2i(corner, corner + Imath::V2i(width - 1, height - 1)));
    header.compression() = compression;
    header.lineOrder() = order;
    Imf::addWhiteLuminance(header, 1);
    Imf::FrameBuffer frame;
    const char *names[3] = {"X", "Y", "Z"};
    for (std::size_t c = 0; c < 3; ++c) {
      header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
      frame.insert(names[c], Imf::Slice::Make(Imf::FLOAT, values.data() + c, header.dataWindow(), 12, 12 * width));
    }
    if (tiles) {
      header.setTileDescription(Imf::TileDescription(16, 24));
      Imf::TiledOutputFile file(path.c_str(), header);
      file.setFrameBuffer(frame);
      file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    } else {
      Imf::OutputFile file(path.c_str(), header);
      file.setFrameBuffer(frame);
      file.writePixels(height);
    }
  };
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    const bool exact = compression <= Imf::PIZ_COMPRESSION || compression == Imf::B44_COMPRESSION ||
                       compression == Imf::B44A_COMPRESSION;  // B44 is for halves
    write(static_cast<Imf::Compression>(compression), Imf::INCREASING_Y, {0, 0}, false);
    check(exact ? 0 : 0.05, "compression " + std::to_string(compression));
  }
  write(Imf::ZIP_COMPRESSION, Imf::DECREASING_Y, {-5, 13}, false);
  check(0, "from the bottom up");
  write(Imf::PIZ_COMPRESSION, Imf::INCREASING_Y, {7, -29}, false);
  check(0, "window above the picture");
  write(Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, {-5, 13}, true);
  check(0, "tiles");
}

}  // namespace greenray
