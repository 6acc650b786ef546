// greenray develop and greenray eye, as a user runs them.
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/tool.hpp"
#include "image/exr.hpp"
#include "image/png.hpp"

namespace greenray::cli_tests {

using Json = nlohmann::json;

class Develop : public ToolTest {
 protected:
  /// A red disk on grey; whiteLuminance 1.
  void write_sun(const std::string &name, double disk_cd_m2 = 1e6) const {
    RgbImage image{64, 48, std::vector<float>(3 * 64 * 48, 200.0F)};
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x)
        if ((x - 32) * (x - 32) + (y - 24) * (y - 24) < 150)
          image.set_pixel(static_cast<std::size_t>(y * 64 + x),
                          {2.6 * disk_cd_m2, 0.62 * disk_cd_m2, 0.03 * disk_cd_m2});
    write_exr(folder / name, image);
  }
  Json stats(const std::string &name) const { return Json::parse(contents(folder / name)); }
};

// oracle: contract: 100 lines of two numbers, equal to pcond's own map.  tolerance: 1e-6, the digits printed
TEST_F(Develop, HistogramToMap) {
  const std::string data = std::string(GREENRAY_TEST_DATA) + "/eye/";
  ASSERT_EQ(run({"develop", "--histogram", data + "hist_a.txt", "--map", "m.txt", "--sensitivity", "on"}).code, 0);
  std::istringstream ours(contents(folder / "m.txt")), theirs(contents(data + "histI_a_s_u100d100.map.txt"));
  double a = 0, b = 0, c = 0, d = 0;
  int rows = 0;
  for (; ours >> a >> b && theirs >> c >> d; ++rows) {
    EXPECT_NEAR(a / c, 1, 1e-6);
    EXPECT_NEAR(b / d, 1, 1e-6);
  }
  EXPECT_EQ(rows, 100);
  EXPECT_EQ(run({"develop", "--histogram", "none.txt", "--map", "m2.txt"}).code, 2);
  write(folder / "bad.txt", "0 1\n1 x\n");
  const Outcome bad = run({"develop", "--histogram", "bad.txt", "--map", "m2.txt"});
  EXPECT_EQ(bad.code, 2);
  EXPECT_NE(bad.err.find("bad.txt:2:1"), std::string::npos) << bad.err;
  EXPECT_FALSE(fs::exists(folder / "m2.txt"));
}

// oracle: contract: the human observer, its flags, greener map and statistics.  tolerance: none
TEST_F(Develop, HumanWithEverything) {
  write_sun("s.exr");
  const Outcome made = run({"develop", "s.exr", "-o", "o.png", "--observer", "human", "--bleaching", "1", "--fov", "1",
                            "--greener", "g.png", "--stats", "s.json", "--bits", "16"});
  ASSERT_EQ(made.code, 0) << made.err;
  const Raster fine = read_png(folder / "o.png");
  EXPECT_EQ(fine.bits, 16);
  ASSERT_EQ(run({"develop", "s.exr", "-o", "o8.png", "--observer", "human", "--bleaching", "1", "--fov", "1"}).code, 0);
  const Raster coarse = read_png(folder / "o8.png");
  for (std::size_t i = 0; i < fine.rgb.size(); ++i) ASSERT_NEAR(fine.rgb[i] / 257.0, coarse.rgb[i], 1.6) << i;
  EXPECT_EQ(read_png(folder / "g.png").width, 64);
  EXPECT_EQ(read_exr(folder / "g.exr").parts.at(0).channels.count("delta_e2000"), 1U);
  const Json json = stats("s.json");
  EXPECT_GT(json.at("greener").at("pixels").get<int>(), 0);
  EXPECT_LT(json.at("bleaching").at("least_unbleached").at("L").get<double>(), 0.9);
  EXPECT_GE(json.at("pupil").at("diameter_mm").get<double>(), 2);
  for (const char *model : {"catch", "shape", "threshold", "adapted"})
    EXPECT_EQ(run({"develop", "s.exr", "-o", "m.png", "--bleaching", "steady", "--bleach-model", model, "-q"}).code, 0);
  EXPECT_EQ(run({"develop", "s.exr", "-o", "l.exr", "--observer", "linear"}).code, 0);
  EXPECT_NEAR(read_exr(folder / "l.exr").rgb().rgb[0], 200, 0.01);
  EXPECT_EQ(run({"develop", "s.exr", "-o", "l.png", "--observer", "linear"}).code, 0);
}

// oracle: contract: exit 2 and nothing written for what cannot be meant.  tolerance: none
TEST_F(Develop, WrongFlagsAndFiles) {
  write_sun("s.exr");
  write(folder / "junk.exr", "no picture");
  write(folder / "h.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\nabc");
  write(folder / "h.txt", "0 1\n1 2\n");
  for (const Words &words :
       std::vector<Words>{{"develop", "s.exr", "-o", "o.png", "--bleaching", "-3"},
                          {"develop", "s.exr", "-o", "o.png", "--bleaching", "soon"},
                          {"develop", "s.exr", "-o", "o.jpg"},
                          {"develop", "s.exr", "-o", "o.png", "--contrast", "1"},
                          {"develop", "s.exr", "-o", "o.png", "--observer", "camera", "--glare", "on"},
                          {"develop", "s.exr", "-o", "o.png", "--fov", "100", "--magnification", "10"},
                          {"develop", "junk.exr", "-o", "o.png", "--observer", "human"},
                          {"develop", "none.exr", "-o", "o.png", "--observer", "human"},
                          {"develop", "h.hdr", "-o", "o.png", "--observer", "human"},
                          {"develop", "s.exr", "-o", "o.png", "--observer", "camera", "--greener", "g.png"},
                          {"develop", "s.exr", "-o", "o.png", "--bleaching", "1", "--greener", "o.png"},
                          {"develop", "s.exr", "-o", "o.exr", "--bleaching", "1", "--greener", "o.png"},
                          {"develop", "s.exr", "-o", "o.png", "--bleaching", "1", "--stats", "./o.png"},
                          {"develop", "--histogram", "h.txt", "--map", "m.txt", "-o", "o.png"},
                          {"develop", "-o", "o.png"},
                          {"develop", "s.exr"}}) {
    const Outcome result = run(words);
    EXPECT_EQ(result.code, 2) << words.back() << result.err;
    EXPECT_FALSE(fs::exists(folder / "o.png") || fs::exists(folder / "o.exr"));
  }
}

// oracle: contract: exit 2 writes nothing, also where only a later picture of a sequence is wrong; without bleaching
//         pictures of a sequence have nothing in common.  tolerance: none
TEST_F(Develop, SequenceThatCannotEndDoesNotBegin) {
  write_sun("a.exr");
  write_exr(folder / "small.exr", RgbImage{5, 4, std::vector<float>(60, 7.0F)});
  for (const char *second : {"small.exr", "none.exr"}) {
    EXPECT_EQ(run({"develop", "a.exr", second, "-o", "f.png", "--bleaching", "1"}).code, 2);
    EXPECT_FALSE(fs::exists(folder / "f-0001.png"));
  }
  EXPECT_EQ(run({"develop", "a.exr", "small.exr", "-o", "f.png", "--observer", "human"}).code, 0);
  EXPECT_TRUE(fs::exists(folder / "f-0002.png"));
}

// oracle: a camera picture has the same pixels whether it is kept in memory or read in rows.  tolerance: none
TEST_F(Develop, CameraStreamsTheSamePixels) {
  RgbImage image{200, 150, std::vector<float>(3 * 200 * 150)};
  for (std::size_t i = 0; i < image.rgb.size(); ++i)
    image.rgb[i] = std::pow(10.0F, static_cast<float>(i * 7919 % 10007) / 2000.0F - 2.0F);
  write_exr(folder / "a.exr", image);
  ASSERT_EQ(run({"develop", "a.exr", "-o", "kept.exr"}).code, 0);
  ASSERT_EQ(run({"develop", "a.exr", "-o", "rows.exr", "--mem", "1"}).code, 0);
  EXPECT_EQ(read_exr(folder / "kept.exr").rgb().rgb, read_exr(folder / "rows.exr").rgb().rgb);
}

// oracle: a Radiance picture by its own rules: (128 + 0.5)/256 2^(129-128) x 179 lm/W / EXPOSURE.  tolerance: 1e-5
TEST_F(Develop, RadiancePicture) {
  std::string hdr = "#?RADIANCE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n";
  for (int i = 0; i < 6; ++i) hdr += std::string("\x80\x80\x80\x81", 4);
  write(folder / "h.hdr", hdr);
  ASSERT_EQ(run({"develop", "h.hdr", "-o", "l.exr", "--observer", "linear"}).code, 0);
  const RgbImage image = read_exr(folder / "l.exr").rgb();
  for (const float v : image.rgb) EXPECT_NEAR(v / (128.5 / 256 * 2 * 179 / 2), 1, 1e-3) << "white is white";
  EXPECT_EQ(run({"develop", "h.hdr", "-o", "h.png", "--observer", "human"}).code, 0);
  // old run-length code: (1, 1, 1, n) repeats, the next one 256 n times
  write(folder / "r.hdr", "#?RADIANCE\n\n-Y 1 +X 301\n" +
                              std::string("\x80\x80\x80\x81\x01\x01\x01\x2b\x01\x01\x01\x01", 12) +
                              std::string("\x40\x40\x40\x81", 4));
  ASSERT_EQ(run({"develop", "r.hdr", "-o", "r.exr", "--observer", "linear"}).code, 0);
  const RgbImage runs = read_exr(folder / "r.exr").rgb();
  EXPECT_EQ(runs.rgb[0], runs.rgb[3 * 299]);
  EXPECT_NEAR(runs.rgb[3 * 300] / runs.rgb[0], 64.5 / 128.5, 1e-5);
  // known by its bytes, not by its name; Radiance's readers take spaces around the format
  hdr.replace(hdr.find("FORMAT="), 7, "FORMAT= ");
  write(folder / "h.rgbe", hdr);
  for (const char *observer : {"camera", "human", "linear"})
    EXPECT_EQ(run({"develop", "h.rgbe", "-o", "r.png", "--observer", observer}).code, 0) << observer;
}

// oracle: a sequence is its pictures one after the other; the state goes on.  tolerance: none
TEST_F(Develop, Sequence) {
  write_sun("a.exr", 3e5), write_sun("b.exr", 60);
  const Outcome made =
      run({"develop", "a.exr", "b.exr", "-o", "f.png", "--bleaching", "1", "--fov", "1", "--stats", "s.json"});
  ASSERT_EQ(made.code, 0) << made.err;
  ASSERT_TRUE(fs::exists(folder / "f-0001.png") && fs::exists(folder / "f-0002.png"));
  const Json frames = stats("s.json").at("frames");
  EXPECT_LT(frames.at(1).at("bleaching").at("least_unbleached").at("L").get<double>(), 0.9)
      << "the second frame alone bleaches nothing";
}

// oracle: golden tables of the formulas: 1e4 cd/m2 through 2 mm.  tolerance: digits given
TEST_F(Develop, EyeState) {
  const Outcome made =
      run({"eye", "--luminance", "1e4", "--field-deg2", "60", "--seconds", "1,3", "--pupil", "de-groot", "--json"});
  ASSERT_EQ(made.code, 0) << made.err;
  const Json json = Json::parse(made.out);
  EXPECT_NEAR(json.at("trolands").get<double>(), 30101.7, 0.05);
  EXPECT_NEAR(json.at("pupil_mm").get<double>(), 2, 1e-12);
  EXPECT_NEAR(json.at("cone_trolands").at("L").get<double>() / 30101.7, 1.1697, 1.2e-3);
  EXPECT_EQ(json.at("unbleached").size(), 2U);
  EXPECT_EQ(run({"eye", "--luminance", "0"}).code, 0);
  EXPECT_EQ(run({"eye", "--luminance", "-1"}).code, 2);
  EXPECT_EQ(run({"eye"}).code, 2);
  write(folder / "s.csv", "nm,radiance\n600,1\n500,1\n");
  EXPECT_EQ(run({"eye", "--luminance", "5", "--spectrum", "s.csv"}).code, 2);
}

}  // namespace greenray::cli_tests
