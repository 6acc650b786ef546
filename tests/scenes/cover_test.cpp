// How much of a gather's disc is surface: against areas in closed form; and what it does to a picture's corners.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "support_code/room_photons.hpp"

namespace greenray {
namespace {

/// Share of Epanechnikov's kernel over the unit disc beyond a chord at distance x (-1..1) from the middle, by its
/// integral over strips: 2/pi (1 - r^2), a strip at y holding (2/pi)(4/3)(1 - y^2)^(3/2).
double share_beyond(double x) {
  constexpr int strips = 20000;
  double sum = 0;
  for (int i = 0; i < strips; ++i) {
    const double y = x + (1 - x) * (i + 0.5) / strips;
    sum += std::pow(1 - y * y, 1.5) * (1 - x) / strips;
  }
  return 8 / (3 * M_PI) * sum;
}

std::vector<room_twin::Cover> covers(const RoomScene &scene, const std::vector<GatherPoint> &points, float radius_m) {
  const auto device = shared_device();
  const RoomLooks looks = room_looks(scene);
  const AirTable air = room_air(scene, looks.wavelength_nm, false);
  const SurfaceTree tree = build_surface_tree(scene.surfaces, SurfaceScene::lanes_for(*device));
  RoomTracer tracer(device, tree, air, looks);
  return tracer.cover(points, std::vector<float>(points.size(), radius_m), 0.25, 0.5);
}

RoomScene with(const std::string &more) {
  return parse_room("cover.toml",
                    "greenray = 1\n[camera]\nfrom = [0, -3, 2]\nto = [0, 0, 0]\n[spectrum]\nsamples = 1\n"
                    "[[light]]\nkind = \"point\"\nfrom = [0, 0, 2]\npower_W = 1\n"
                    "[[quad]]\ncorner = [-1, -1, 0]\nedge_u = [2, 0, 0]\nedge_v = [0, 2, 0]\nreflectance = 0.5\n" +
                        more);
}

std::vector<GatherPoint> floor_line(double y, double from, double step, int count) {
  std::vector<GatherPoint> points;
  for (int i = 0; i < count; ++i)
    points.push_back(
        {{static_cast<float>(from + step * i), static_cast<float>(y), 0}, room_twin::pack_normal(0, 0, 1)});
  return points;
}

// oracle: the share of the kernel on this side of a straight edge, whatever makes it: the end of the floor, a wall, a
//         block that stands on the floor; means over 200 turns of the pattern
// tolerance: 0.01 of the mean (a rim of 0.9 r misses what an edge beyond 0.78 r takes: 0.9 %); each one: 1/8 (two of
// 16)
TEST(Cover, StraightEdges) {
  const std::string wall = "[[quad]]\ncorner = [-1, 1, 0]\nedge_u = [2, 0, 0]\nedge_v = [0, 0, 1]\nreflectance = 0.5\n";
  const std::string block = "[[box]]\nlow = [-0.9, 0.5, 0]\nhigh = [0.9, 0.9, 0.3]\nreflectance = 0.5\n";
  const std::string low = "[[box]]\nlow = [-0.9, 0.5, -0.5]\nhigh = [0.9, 0.9, 0.3]\nreflectance = 0.5\n";
  for (const auto &[more, edge_y] : {std::pair<std::string, double>{"", 1}, {wall, 1}, {block, 0.5}, {low, 0.5}})
    for (const double at : {0.02, 0.3, 0.6, 0.95, 1.3}) {
      constexpr double radius_m = 0.1;
      const auto found = covers(with(more), floor_line(edge_y - at * radius_m, -0.6, 0.006, 200), 0.1f);
      const double expected = 1 - (at < 1 ? share_beyond(at) : 0);
      const double inner = 1 - (at * std::sqrt(2) < 1 ? share_beyond(at * std::sqrt(2)) : 0);
      double whole = 0, half = 0;
      for (const room_twin::Cover &c : found) {
        whole += static_cast<double>(c.whole) / 200, half += static_cast<double>(c.inner) / 200;
        EXPECT_NEAR(static_cast<double>(c.whole), expected, 0.125);
      }
      EXPECT_NEAR(whole, expected, 0.01) << edge_y << " " << at;
      EXPECT_NEAR(half, inner, 0.02) << edge_y << " " << at;
    }
}

// oracle: a corner of two walls leaves a quarter; glass over the floor takes nothing; a mirror laid into it takes half
// tolerance: two of 16 looks for one place; 0.02 for the mean of 200, whose turns are random
TEST(Cover, CornersGlassAndMirrors) {
  const std::string walls =
      "[[quad]]\ncorner = [-1, 1, 0]\nedge_u = [2, 0, 0]\nedge_v = [0, 0, 1]\nreflectance = 0.5\n"
      "[[quad]]\ncorner = [1, -1, 0]\nedge_u = [0, 2, 0]\nedge_v = [0, 0, 1]\nreflectance = 0.5\n";
  double mean = 0;
  for (const auto &c : covers(with(walls), floor_line(0.9999, 0.9999, 0, 1), 0.1f))
    mean += static_cast<double>(c.whole);
  EXPECT_NEAR(mean, 0.25, 0.125);
  const std::string glass =
      "[[material]]\nname = \"glass\"\nkind = \"dielectric\"\nindex = 1.5\n"
      "[[sphere]]\ncentre = [0, 0, 0.101]\nradius_m = 0.1\nmaterial = \"glass\"\n";
  for (const auto &c : covers(with(glass), floor_line(0, -0.1, 0.01, 20), 0.05f)) EXPECT_EQ(c.whole, 1);
  const std::string mirror =
      "[[material]]\nname = \"mirror\"\nkind = \"mirror\"\nreflectance = 0.9\n"
      "[[quad]]\ncorner = [-1, -1, 1e-4]\nedge_u = [2, 0, 0]\nedge_v = [0, 1, 0]\nmaterial = \"mirror\"\n";
  double half = 0;
  for (const auto &c : covers(with(mirror), floor_line(1e-4, -0.6, 0.006, 200), 0.1f))
    half += static_cast<double>(c.whole) / 200;
  EXPECT_NEAR(half, 0.5, 0.02);
}

// oracle: a furnace is even up to its corners: radiance 1/(1 - a)/pi everywhere
// tolerance: 3 % for the mean of the pixels that see the places within 3 cm of an edge, whose discs are cut;
//            their noise is 1.3 % for 400 photons, a third in 300 pixels
TEST(Cover, FurnaceIsEvenUpToItsEdges) {
  const RoomScene scene =
      parse_room("furnace.toml",
                 "greenray = 1\n[camera]\nfrom = [0.5, 0.5, 0.5]\nto = [1.0, 1.0, 0.0]\nup = [0, 0, 1]\nfov_deg = 40\n"
                 "[[box]]\nname = \"walls\"\nlow = [0, 0, 0]\nhigh = [1, 1, 1]\ninward = true\nreflectance = 0.5\n"
                 "[[light]]\nkind = \"area\"\nsurface = \"walls\"\npower_W = 6.0\n"
                 "[spectrum]\nsamples = 1\n[photons]\nemitted = 200000\ngather = 400\n");
  RoomOptions options;
  options.size = {60, 60}, options.spp = 4;
  const SpectralImage image = render_room(scene, options, shared_device()).image;
  const Triple from{0.5, 0.5, 0.5}, ahead = unit({1, 1, -1}), right = unit(cross(ahead, {0, 0, 1})),
                                    up = cross(right, ahead);
  const double pixel = 2 * std::tan(20 * M_PI / 180) / 60;
  double sum = 0, whole = 0;
  int count = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) {
      const Triple d = ahead + ((x + 0.5 - 30) * pixel) * right + ((30 - y - 0.5) * pixel) * up;
      double t = 1e9;
      for (std::size_t a = 0; a < 3; ++a) t = std::min(t, 0.5 / std::abs(d[a]));
      const Triple at = from + t * d;
      int near_walls = 0;
      for (std::size_t a = 0; a < 3; ++a) near_walls += std::abs(std::abs(at[a] - 0.5) - 0.5) < 0.03;
      const double value = static_cast<double>(image.radiance[static_cast<std::size_t>(60 * y + x)]) * M_PI / 2;
      whole += value / 3600;
      if (near_walls >= 2) sum += value, ++count;
    }
  ASSERT_GT(count, 300);
  EXPECT_NEAR(sum / count, 1, 0.03);
  EXPECT_NEAR(whole, 1, 0.005);
}

// oracle: two furnaces side by side, the walls between them 2 mm thick and the floors in one plane; the one that is
// seen
//         is a twentieth as bright, and its radiance M/(1 - a)/pi is the same everywhere, at the foot of the wall too
// tolerance: blocks of 4 x 4 pixels 0.1: 5 times 2 %, the noise of 400 photons in 4 passes and 16 pixels that share
//         them; mean 1 %. Discs that count photons behind the wall were 0.75 and 7 % off
TEST(Cover, NoLightComesThroughAThinWall) {
  std::string text =
      "greenray = 1\n[camera]\nfrom = [1.9, 0.5, 0.6]\nto = [1.1, 0.5, 0.0]\nfov_deg = 70\n[spectrum]\nsamples = 1\n"
      "[photons]\nemitted = 400000\ngather = 400\n";
  for (const auto &[name, low, power] : {std::tuple("bright", "0", "120"), {"dim", "1.002", "6"}}) {
    const std::string high = std::string(name) == "dim" ? "2.002" : "1";
    text += std::string("[[box]]\nname = \"") + name + "\"\nlow = [" + low + ", 0, 0]\nhigh = [" + high +
            ", 1, 1]\ninward = true\nreflectance = 0.5\n[[light]]\nkind = \"area\"\nsurface = \"" + name +
            "\"\npower_W = " + power + "\nphoton_weight = " + (std::string(name) == "dim" ? "20" : "1") + "\n";
  }
  RoomOptions options;
  options.size = {64, 48};
  const SpectralImage image = render_room(parse_room("thin.toml", text), options, shared_device()).image;
  double mean = 0;
  for (int by = 0; by < 12; ++by)
    for (int bx = 0; bx < 16; ++bx) {
      double block = 0;
      for (int k = 0; k < 16; ++k)
        block +=
            static_cast<double>(image.radiance[static_cast<std::size_t>((4 * by + k / 4) * 64 + 4 * bx + k % 4)]) / 16;
      EXPECT_NEAR(block * M_PI / 2, 1, 0.1) << bx << " " << by;
      mean += block * M_PI / 2 / 192;
    }
  EXPECT_NEAR(mean, 1, 0.01);
}

// oracle: a wall 0.05 m away in a disc of 0.1 m: half of the radius is clear where the floor goes on behind it, and the
//         hidden place is there; all of it where the floor ends at the wall
// tolerance: 4 %: directions 15 degrees from the nearest point
TEST(Cover, TellsHowFarTheWallIs) {
  const std::string wall =
      "[[quad]]\ncorner = [-1, 0.5, 0]\nedge_u = [2, 0, 0]\nedge_v = [0, 0, 1]\nreflectance = 0.5\n";
  for (const room_twin::Cover &c : covers(with(wall), floor_line(0.45, -0.6, 0.006, 200), 0.1f)) {
    EXPECT_GE(c.clear, 0.499f);
    EXPECT_LE(c.clear, 0.52f);
    EXPECT_GT(c.hidden[1], 0.5f);
    EXPECT_NEAR(c.hidden[2], 0, 1e-5);
  }
  const std::string at_end =
      "[[quad]]\ncorner = [-1, 1, 0]\nedge_u = [2, 0, 0]\nedge_v = [0, 0, 1]\nreflectance = 0.5\n";
  for (const room_twin::Cover &c : covers(with(at_end), floor_line(0.95, -0.6, 0.006, 200), 0.1f))
    EXPECT_EQ(c.clear, 1);
}

}  // namespace
}  // namespace greenray
