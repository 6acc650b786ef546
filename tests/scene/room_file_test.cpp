// Scenes with surfaces: what is said about wrong ones, meshes and materials of every form, and what textures become.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "image/exr.hpp"
#include "image/png.hpp"
#include "image/uplift.hpp"
#include "render/room_looks.hpp"
#include "scene/obj_file.hpp"
#include "scene/room_scene.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;

class RoomFile : public ::testing::Test {
 protected:
  RoomFile() { fs::create_directories(folder); }
  ~RoomFile() override {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
  void write(const std::string &name, const std::string &text) const { std::ofstream(folder / name) << text; }

  std::vector<Diagnostic> complaints(const std::string &rows) const {
    try {
      parse_room((folder / "room.toml").string(), head + rows);
    } catch (const InputError &error) {
      return error.diagnostics();
    }
    return {};
  }
  /// One complaint, in this file at this line, with these words in it.
  void expect(const std::string &rows, const std::string &file, int line, const std::string &words) const {
    const std::vector<Diagnostic> found = complaints(rows);
    ASSERT_FALSE(found.empty()) << "nothing was said about\n" << rows;
    EXPECT_EQ(fs::path(found[0].place.file).filename().string(), file) << found[0].message;
    EXPECT_EQ(found[0].place.line, line) << found[0].message;
    EXPECT_NE(found[0].message.find(words), std::string::npos) << found[0].message;
  }
  void expect_obj(const std::string &obj, int line, const std::string &words) const {
    write("m.obj", obj);
    expect("[[mesh]]\nfile = \"m.obj\"\nreflectance = 0.5\n", "m.obj", line, words);
  }

  fs::path folder = fs::temp_directory_path() / ("greenray-room-file-" + std::to_string(getpid()));
  // 10 lines, so that rows begin at line 11
  const std::string head =
      "greenray = 1\n[camera]\nfrom = [0, -3, 1]\nto = [0, 0, 0]\n[[light]]\nkind = \"point\"\nfrom = [0, 0, 2]\n"
      "power_W = 1\n[spectrum]\nsamples = 3\n";
};

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

// oracle: user-experience.md: file:line:column, what was expected; all of it before anything is rendered
// tolerance: none
TEST_F(RoomFile, SaysWhatIsWrongWithMeshes) {
  expect("[[mesh]]\nfile = \"none.obj\"\nreflectance = 0.5\n", "room.toml", 12, "none.obj");
  expect_obj(square + "f 1 2 5\n", 5, "1 to 4, found 5");
  expect_obj(square + "f 1 2 0\n", 5, "");
  expect_obj(square + "f 1 2 -5\n", 5, "");
  expect_obj(square + "f 1 2\n", 5, "three corners");
  expect_obj(square + "v 2 0 0\nf 1 2 5\n", 6, "area");
  expect_obj(square + "f 1 1 1\n", 5, "area");
  expect_obj("v 0 0 nan\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", 1, "number");
  expect_obj("v 0 0 inf\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", 1, "number");
  expect_obj("v 0 0 1e999\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", 1, "number");
  expect_obj("v 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", 1, "number");
  expect_obj(square + "vn 0 0 1\nf 1//1 2//1 3//2\n", 6, "normal");
  expect_obj(square + "f 1/1 2/1 3/1\n", 5, "texture");
  expect_obj("mtllib none.mtl\n" + square + "f 1 2 3\n", 1, "none.mtl");
  for (const char *face : {"f", "f 1.5 2 3", "f 99999999999999999999 1 2", "f 1/a 2 3", "f 1/ 2 3", "f 1/1/1/1 2 3"})
    expect_obj(square + face + "\n", 5, "corners");
  expect_obj(square + "v 0 0 0" + std::string(1, '\0') + "\nf 1 2 3\n", 5, "zero byte");
  write("e.obj", square);
  EXPECT_FALSE(complaints("[[mesh]]\nfile = \"e.obj\"\nreflectance = 0.5\n").empty()) << "no faces at all";
}

TEST_F(RoomFile, SaysWhatIsWrongWithMaterialsLightsAndTextures) {
  const std::string quad = "[[quad]]\ncorner = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\n";
  expect(quad + "material = \"whte\"\n[[material]]\nname = \"white\"\nreflectance = 0.5\n", "room.toml", 15, "white");
  expect("[[quad]]\ncorner = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [2, 0, 0]\nreflectance = 0.5\n", "room.toml", 14,
         "");
  expect(quad + "reflectance = 1.5\n", "room.toml", 15, "1.5");
  expect(quad + "reflectance = nan\n", "room.toml", 15, "");
  expect("[[sphere]]\ncentre = [0, 0, 0]\nradius_m = 0\nreflectance = 0.5\n", "room.toml", 13, "");
  write("m.obj", "mtllib m.mtl\nusemtl a\n" + square + "f 1 2 3\n");
  for (const char *row : {"Kd nan 0 0", "Kd a b c", "Kd 0.5 0.5", "Kd 0 0 1.5", "Ks -1 0 0", "Ke -5 -5 -5",
                          "Ke inf 0 0", "Ni -1", "Ni nan", "Ni 1e9", "d nan", "d 2", "Tr -1"}) {
    write("m.mtl", std::string("# one\nnewmtl a\n") + row + "\n");
    expect("[[mesh]]\nfile = \"m.obj\"\n", "m.mtl", 3, "expected");
  }
  write("m.obj", "usemtl unknown\n" + square + "f 1 2 3\n");
  expect("[[mesh]]\nfile = \"m.obj\"\n", "m.obj", 1, "unknown");
  const std::string textured = "[[material]]\nname = \"t\"\ntexture = ";
  expect(textured + "\"none.png\"\n" + quad + "material = \"t\"\n", "room.toml", 13, "none.png");
  expect(textured + "\"t.gif\"\n" + quad + "material = \"t\"\n", "room.toml", 13, ".png or .exr");
  expect(quad + "reflectance = 0.5\n[[light]]\nkind = \"area\"\nsurface = \"lmp\"\npower_W = 1\n", "room.toml", 18,
         "lmp");
  expect(quad +
             "reflectance = 0.5\n[[light]]\nkind = \"spot\"\nfrom = [0, 0, 1]\nto = [0, 0, 1]\ncone_deg = 10\npower_W "
             "= 1\n",
         "room.toml", 19, "other than");
}

// oracle: a picture that is none says so when it is read, at the place that names it or in the picture itself
// tolerance: none
TEST_F(RoomFile, BadPicturesAreInputErrors) {
  write("bad.png", "this is no picture");
  write("bad.exr", "nor is this");
  for (const char *name : {"bad.png", "bad.exr"}) {
    const RoomScene scene = parse_room((folder / "room.toml").string(),
                                       head + "[[material]]\nname = \"t\"\ntexture = \"" + name +
                                           "\"\n[[quad]]\ncorner = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\n"
                                           "material = \"t\"\n");
    EXPECT_THROW((void)room_looks(scene), InputError) << name;
  }
}

// oracle: areas of the polygons: a convex one by the shoelace formula, an L of three unit squares
// tolerance: 1e-12
TEST_F(RoomFile, FacesOfAnyShape) {
  const auto area = [](const std::string &text) {
    double sum = 0;
    for (const Triangle &t : parse_obj("m.obj", text, [](const std::string &) { return std::nullopt; }).triangles) {
      EXPECT_GT(t.area_vector_m2()[2], 0) << "a corner was turned around";
      sum += length(t.area_vector_m2());
    }
    return sum;
  };
  EXPECT_NEAR(area(square + "f 1 2 3 4\n"), 1, 1e-12);
  EXPECT_NEAR(area(square + "f -4 -3 -2 -1\n"), 1, 1e-12);
  const std::string l = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n";
  EXPECT_NEAR(area(l + "f 1 2 3 4 5 6\n"), 3, 1e-12);
  EXPECT_NEAR(area(l + "f 4 5 6 1 2 3\n"), 3, 1e-12);
}

// oracle: the texels written here; PNG through the sRGB curve (IEC 61966-2-1) and EXR linear are the same reflectance;
//         uplift: a spectrum that has the colour asked for (Jakob & Hanika 2019), within 0..1, and grey for grey
// tolerance: 8 bits of PNG: 0.004 and the solver's; 1e-3: the solver's, colours stand in steps of 1/4096
TEST_F(RoomFile, TexturesAndUplift) {
  const std::array<std::array<double, 3>, 4> colours{
      {{0.8, 0.1, 0.1}, {0.1, 0.6, 0.2}, {0.1, 0.1, 0.7}, {0.5, 0.5, 0.5}}};
  RgbImage linear{2, 2, {}};
  Raster raster;
  raster.width = raster.height = 2;
  for (const auto &c : colours)
    for (const double x : c) {
      linear.rgb.push_back(static_cast<float>(x));
      const double s = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
      raster.rgb.push_back(static_cast<std::uint16_t>(std::lround(255 * s)));
    }
  write_exr(folder / "t.exr", linear);
  write_png(folder / "t.png", raster);
  const Uplift uplift;
  for (const char *name : {"t.png", "t.exr"}) {
    const RoomScene scene = parse_room((folder / "room.toml").string(),
                                       head + "[[material]]\nname = \"t\"\ntexture = \"" + name +
                                           "\"\n[[quad]]\ncorner = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\n"
                                           "material = \"t\"\n");
    const RoomLooks looks = room_looks(scene);
    ASSERT_EQ(looks.textures.size(), 1u);
    ASSERT_EQ(looks.texels.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
      // v = 0 is the lowest row: rows come the other way round
      const auto &t = looks.texels[i % 2 + 2 * (1 - i / 2)];
      const CurveCoefficients c{static_cast<double>(t.c0), static_cast<double>(t.c1), static_cast<double>(t.c2)};
      const Rgb seen = uplift.colour(c);
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(seen[k], colours[i][k], name[2] == 'p' ? 5e-3 : 1e-3) << name << i;
      for (const double nm : looks.wavelength_nm) {
        EXPECT_GE(curve_value(c, nm), 0);
        EXPECT_LE(curve_value(c, nm), 1);
        if (i == 3) {
          EXPECT_NEAR(curve_value(c, nm), 0.5, 5e-3) << "grey is grey";
        }
      }
    }
  }
}

}  // namespace
}  // namespace greenray
