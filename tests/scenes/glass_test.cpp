// Light through glass: the caustic under a sphere against an independent tracer of light.
#include <gtest/gtest.h>

#include <fstream>

#include "render/room.hpp"
#include "support_code/light_tracer.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

struct PixelGrid {
  Triple from, ahead, right, up;
  double pixel;
  int width, height;
  PixelGrid(const CameraScene &c, int w, int h) : from(c.from), width(w), height(h) {
    ahead = unit(c.to - c.from), right = unit(cross(ahead, c.up)), up = cross(right, ahead);
    pixel = 2 * std::tan(c.fov_deg * M_PI / 360) / w;
  }
  Triple direction(double x, double y) const {
    return ahead + ((x - 0.5 * width) * pixel) * right + ((0.5 * height - y) * pixel) * up;
  }
  /// Of a place; -1 outside the picture.
  int of(const Triple &place) const {
    const Triple d = place - from;
    const double depth = dot(d, ahead), x = dot(d, right) / depth / pixel + 0.5 * width,
                 y = 0.5 * height - dot(d, up) / depth / pixel;
    if (depth <= 0 || x < 0 || y < 0 || x >= width || y >= height) return -1;
    return static_cast<int>(y) * width + static_cast<int>(x);
  }
};

// oracle: packets in double through sphere and air (support_code/light_tracer.hpp), counted on the floor of each pixel:
//         no density estimate, no map
// tolerance: 2 % relative RMS of blocks of 4x4 pixels, the noise of both taken off
TEST(Glass, CausticOfASphereLikeTheLightTracer) {
  const RoomScene scene = parse_room(
      "caustic.toml",
      "greenray = 1\n[camera]\nfrom = [0.0, -1.6, 0.8]\nto = [0.0, 0.0, 0.0]\nfov_deg = 20\n[spectrum]\nsamples = 1\n"
      "[[material]]\nname = \"glass\"\nkind = \"dielectric\"\nindex = 1.5\n"
      "[[quad]]\ncorner = [-2, -2, 0]\nedge_u = [4, 0, 0]\nedge_v = [0, 4, 0]\nreflectance = 0.4\n"
      "[[sphere]]\ncentre = [0, 0, 0.6]\nradius_m = 0.2\nmaterial = \"glass\"\n"
      "[[light]]\nkind = \"spot\"\nfrom = [0.1, 0, 2]\nto = [0, 0, 0.6]\ncone_deg = 15\npower_W = 10\n"
      "[photons]\nemitted = 2000000\ngather = 60\n");
  constexpr int width = 48, height = 36, block = 4;
  constexpr int seeds = 4;
  std::vector<SpectralImage> ours;
  for (int seed = 1; seed <= seeds; ++seed) {
    RoomOptions options;
    options.size = {width, height}, options.spp = 64, options.seed = static_cast<std::uint32_t>(seed);
    const RoomPicture picture = render_room(scene, options, shared_device());
    EXPECT_GT(picture.report.photons.stored[1], 100000u) << "caustic photons";
    ours.push_back(picture.image);
  }

  const PixelGrid grid(scene.camera, width, height);
  std::vector<double> packets(width * height, 0.0), power(width * height, 0.0);
  std::mt19937_64 engine(7);
  constexpr int count = 3000000;
  LightTracer(scene, 550).trace(count, engine, [&](const Triple &place, const Triple &normal, double watts) {
    if (normal[2] < 0.5) return;
    if (const int p = grid.of(place); p >= 0)
      packets[static_cast<std::size_t>(p)] += 1, power[static_cast<std::size_t>(p)] += watts;
  });
  double squares = 0, noise = 0, whole = 0, brightest = 0;
  int blocks = 0;
  for (int y = 0; y < height; y += block)
    for (int x = 0; x < width; x += block) {
      double b = 0, n = 0, a[seeds] = {};
      bool is_floor = true;
      for (int j = 0; j < block; ++j)
        for (int i = 0; i < block; ++i) {
          const auto p = static_cast<std::size_t>((y + j) * width + x + i);
          const Triple d = grid.direction(x + i + 0.5, y + j + 0.5);
          is_floor = is_floor && d[2] < 0 && brute_force(scene.surfaces, grid.from, d, 1e9, 0).certain.primitive < 2 &&
                     brute_force(scene.surfaces, grid.from, d, 1e9, 0.02).possible.primitive < 2;
          // Floor of a pixel: pixel^2 at depth 1, t^2 of it at depth t, over the cosine z/t of the floor to d.
          const double t = -grid.from[2] / d[2];
          const double area_m2 = grid.pixel * grid.pixel * t * t * t / grid.from[2];
          for (int k = 0; k < seeds; ++k)
            a[k] += static_cast<double>(ours[static_cast<std::size_t>(k)].radiance[p]) / (block * block);
          b += 0.4 / M_PI * power[p] / area_m2 / (block * block), n += packets[p];
        }
      if (!is_floor || n < 1) continue;
      double mean = 0, spread = 0;
      for (const double one : a) mean += one / seeds;
      for (const double one : a) spread += (one - mean) * (one - mean) / (seeds * (seeds - 1));
      squares += (mean - b) * (mean - b), noise += b * b / n + spread, whole += b, brightest = std::max(brightest, b);
      ++blocks;
    }
  ASSERT_GT(blocks, 60);
  EXPECT_GT(brightest, 8 * whole / blocks) << "there is a caustic in the picture";
  const double relative = std::sqrt(std::max(squares - noise, 0.0) / blocks) / (whole / blocks);
  std::cout << "caustic: relative RMS after noise " << relative << ", noise of both "
            << std::sqrt(noise / blocks) / (whole / blocks) << ", blocks " << blocks << "\n";
  EXPECT_LT(relative, 0.02);
}

}  // namespace
}  // namespace greenray
