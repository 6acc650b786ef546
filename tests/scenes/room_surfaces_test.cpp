// What surfaces do to light, seen in whole pictures: textures, dispersing glass, mirrors in a medium.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "image/png.hpp"
#include "render/room.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

RoomPicture rendered(const std::string &text, int side, int spp) {
  RoomOptions options;
  options.size = {side, side}, options.spp = spp;
  return render_room(parse_room("room.toml", text), options, shared_device());
}

double mean_of_wave(const SpectralImage &image, std::size_t wave) {
  const std::size_t waves = image.wavelength_nm.size();
  double sum = 0;
  for (std::size_t i = wave; i < image.radiance.size(); i += waves) sum += static_cast<double>(image.radiance[i]);
  return sum * static_cast<double>(waves) / static_cast<double>(image.radiance.size());
}

// oracle: between mirrors all light of the floor goes up; where n falls, what is steeper than total reflection allows:
//         (n_top/n_floor)^2 of it. The ceiling's light comes back to it by total reflection where n falls downwards:
//         E = (P/A) min(1, (n_t/n_f)^2) / (1 - a max(0, 1 - (n_f/n_t)^2)), the floor being black; seen L = a E/pi
//         (n_eye/n_t)^2
// tolerance: 2 %: 400000 photons with 100 an estimate are good to 0.5 % over 1024 pixels, and edges are cut
TEST(RoomSurfaces, MirrorsInAMedium) {
  for (const auto &[floor, top] : {std::pair{1.0, 1.3}, {1.3, 1.0}}) {
    std::ostringstream text;
    text
        << "greenray = 1\n[atmosphere]\nfield = { kind = \"layers\", height_m = [0.0, 1.0], refractivity = ["
        << floor - 1 << ", " << top - 1
        << "] }\n[camera]\nfrom = [0.5, 0.5, 0.9]\nto = [0.5, 0.5, 1]\nup = [0, 1, 0]\nfov_deg = 40\n"
        << "[spectrum]\nrange_nm = [550, 550]\nsamples = 1\n[[material]]\nname = \"mirror\"\nkind = \"mirror\"\n"
        << "reflectance = 1.0\n[[quad]]\nname = \"lamp\"\ncorner = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\n"
        << "reflectance = 0\n[[quad]]\ncorner = [0, 0, 1]\nedge_u = [0, 1, 0]\nedge_v = [1, 0, 0]\nreflectance = 0.5\n";
    for (const char *wall : {"corner = [0, 1, 0]\nedge_u = [1, 0, 0]", "corner = [0, 0, 0]\nedge_u = [0, 1, 0]",
                             "corner = [1, 1, 0]\nedge_u = [0, -1, 0]", "corner = [0, 0, 0]\nedge_u = [1, 0, 0]"})
      text << "[[quad]]\n" << wall << "\nedge_v = [0, 0, 1]\nmaterial = \"mirror\"\n";
    text << "[[light]]\nkind = \"area\"\nsurface = \"lamp\"\npower_W = 1\n[photons]\nemitted = 400000\ngather = 100\n";
    const double eye = floor + 0.9 * (top - floor), falls = std::pow(std::min(1.0, top / floor), 2);
    const double back = 0.5 * std::max(0.0, 1 - std::pow(floor / top, 2));
    const double expected = 0.5 / M_PI * falls / (1 - back) * std::pow(eye / top, 2);
    EXPECT_NEAR(mean_of_wave(rendered(text.str(), 32, 8).image, 0) / expected, 1, 0.02) << floor << " " << top;
  }
}

// oracle: a floor under a Sun straight above has L = albedo E/pi; u runs along the first edge, v along the second, and
// a
//         picture's first row is at v = 1; sRGB is IEC 61966-2-1
// tolerance: 4 %: pixels in the middle of a quarter, 4 x 4 of them with 1500 photons each
TEST(RoomSurfaces, TextureLiesAsItShould) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("greenray-texture-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  Raster raster{8, 8, 8, {}};
  const int level[2][2] = {{255, 188}, {137, 99}};  // of the picture's upper and lower, left and right quarters
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)
      for (int k = 0; k < 3; ++k) raster.rgb.push_back(static_cast<std::uint16_t>(level[y / 4][x / 4]));
  write_png(folder / "four.png", raster);
  std::ofstream(folder / "m.obj")
      << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
  const std::string text =
      "greenray = 1\n[camera]\nfrom = [0.5, 0.5, 5]\nto = [0.5, 0.5, 0]\nup = [0, 1, 0]\nfov_deg = 11.42\n[spectrum]\n"
      "range_nm = [550, 550]\nsamples = 1\n[[material]]\nname = \"four\"\nkind = \"lambert\"\ntexture = \"four.png\"\n"
      "[[mesh]]\nfile = \"m.obj\"\nmaterial = \"four\"\n[[light]]\nkind = \"sun\"\naltitude_deg = 90\n"
      "irradiance_W_m2 = 1\ndiameter_deg = 0\n[photons]\nemitted = 400000\ngather = 1500\n";
  RoomOptions options;
  options.size = {24, 24}, options.spp = 8;
  const SpectralImage image =
      render_room(parse_room((folder / "room.toml").string(), text), options, shared_device()).image;
  std::filesystem::remove_all(folder);
  for (int v = 0; v < 2; ++v)
    for (int u = 0; u < 2; ++u) {
      double sum = 0;
      for (int y = 4; y < 8; ++y)
        for (int x = 4; x < 8; ++x)
          sum += static_cast<double>(image.radiance[static_cast<std::size_t>((12 * v + y) * 24 + 12 * u + x)]);
      const double encoded = level[v][u] / 255.0, albedo = std::pow((encoded + 0.055) / 1.055, 2.4);
      EXPECT_NEAR(sum / 16 / (albedo / M_PI), 1, 0.04) << u << " " << v;
    }
}

// oracle: a flat slab of glass in a medium lets 4 n n0/(n + n0)^2 through at either side, and all wavelengths go the
//         same way: photons and eye paths that were split inside must bring each wavelength its own power
// tolerance: 6 %: at each wavelength a quarter of the photons, and of the eye's paths, that 1 % would need
TEST(RoomSurfaces, DispersingSlabKeepsEveryWavelength) {
  for (const double n0 : {1.0, 1.3}) {
    std::ostringstream scene;
    scene
        << "greenray = 1\n[atmosphere]\nfield = { kind = \"layers\", height_m = [0.0, 9.0], refractivity = [" << n0 - 1
        << ", " << n0 - 1 << "] }\n"
        << "[camera]\nfrom = [0, 0, 1.5]\nto = [0, 0, 3]\nup = [0, 1, 0]\nfov_deg = 6\n[spectrum]\n"
        << "range_nm = [450, 650]\nsamples = 4\n[[material]]\nname = \"glass\"\nkind = \"dielectric\"\n"
        << "cauchy = { A = 1.5, B_um2 = 0.01 }\n[[box]]\nlow = [-9, -9, 2]\nhigh = [9, 9, 2.1]\nmaterial = \"glass\"\n"
        << "[[quad]]\ncorner = [-1, -1, 3]\nedge_u = [0, 2, 0]\nedge_v = [2, 0, 0]\nreflectance = 0.5\n"
        << "[[light]]\nkind = \"spot\"\nfrom = [0, 0, 1]\nto = [0, 0, 3]\ncone_deg = 10\npower_W = 1\n"
        << "[photons]\nemitted = 400000\ngather = 150\n";
    const std::string text = scene.str();
    const SpectralImage image = rendered(text, 16, 16).image;
    const RoomPicture open =
        rendered(text.substr(0, text.find("[[box]]")) + text.substr(text.find("[[quad]]")), 16, 16);
    for (std::size_t w = 0; w < 4; ++w) {
      const double um = 1e-3 * image.wavelength_nm[w], n = 1.5 + 0.01 / (um * um);
      const double one = 4 * n * n0 / std::pow(n + n0, 2), again = std::pow((n - n0) / (n + n0), 4);
      const double slab = one * one / (1 - again), nearer = std::pow(2 / (1.9 + 0.1 * n0 / n), 2);
      EXPECT_NEAR(mean_of_wave(image, w) / mean_of_wave(open.image, w), slab * slab * nearer, 0.06) << n0 << " " << w;
    }
  }
}

}  // namespace
}  // namespace greenray
