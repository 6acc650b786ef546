// The picture of the photon map: which pixel shows a photon, through straight and through bent paths of the eye.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "render/photon_mapper.hpp"
#include "render/photon_picture.hpp"
#include "render/room.hpp"
#include "render/room_eye.hpp"
#include "render/room_looks.hpp"
#include "support_code/twin_traits.hpp"
#include "twin/photon_twin.hpp"

namespace greenray {
namespace {

constexpr int columns = 120, rows = 90;
constexpr double eye_m = 1.0, wall_m = 6.0;

/// An eye at (0, 0, 1) that looks along +x at a wall 6 m away, in a medium n = 1.3 - 0.05 z, or in none.
RoomScene wall_scene(bool bent) {
  return parse_room("wall.toml",
                    std::string("greenray = 1\n") +
                        (bent ? "[atmosphere]\nfield = { kind = \"layers\", height_m = [0.0, 10.0], refractivity = "
                                "[0.3, -0.2] }\n"
                              : "") +
                        "[camera]\nfrom = [0, 0, 1]\nto = [1, 0, 1]\nfov_deg = 40\nresolution = [120, 90]\n"
                        "[[quad]]\ncorner = [6, -5, -5]\nedge_u = [0, 10, 0]\nedge_v = [0, 0, 10]\nreflectance = 0.5\n"
                        "[[light]]\nkind = \"point\"\nfrom = [1, 0, 1]\npower_W = 1\n"
                        "[spectrum]\nsamples = 1\n[photons]\nemitted = 20000\n");
}

/// Where the paths of all pixels end, one sample each.
std::vector<GatherPoint> ends_of(const RoomScene &scene) {
  RoomOptions options;
  options.size = {columns, rows};
  options.spp = 1;
  const auto device = shared_device();
  const RoomLooks looks = room_looks(scene);
  const AirTable air = room_air(scene, looks.wavelength_nm, false);
  const SurfaceTree tree = build_surface_tree(scene.surfaces, SurfaceScene::lanes_for(*device));
  RoomTracer tracer(device, tree, air, looks);
  room_twin::EyeCamera camera{};
  camera.place[2] = static_cast<float>(eye_m);
  camera.ahead[0] = camera.up[2] = 1, camera.right[1] = -1;
  camera.pixel_tangent = static_cast<float>(2 * std::tan(20 * M_PI / 180) / columns);
  camera.centre_column = columns / 2.0f, camera.centre_row = rows / 2.0f;
  camera.width = columns, camera.rows = rows, camera.samples = 1, camera.most_bounces = 4, camera.seed = 3;
  std::vector<GatherPoint> ends;
  for (const room_twin::EyeSample &sample : tracer.see(camera).samples) {
    GatherPoint end = no_place();
    if (sample.asks) {
      std::copy(std::begin(sample.point.place_m), std::end(sample.point.place_m), end.place_m);
      end.normal = sample.point.normal;
    }
    ends.push_back(end);
  }
  return ends;
}

/// Slope at the eye of the ray that reaches the wall at a height: n linear in z, so that it is the catenary
/// n = q cosh(g x/q + asinh(slope)), q = n(eye)/sqrt(1 + slope^2).
double slope_to(double height_m, bool bent) {
  if (!bent) return (height_m - eye_m) / wall_m;
  const double g = -0.05, n0 = 1.3;
  const auto at_wall = [&](double slope) {
    const double q = (n0 + g * eye_m) / std::sqrt(1 + slope * slope);
    return (q * std::cosh(g * wall_m / q + std::asinh(slope)) - n0) / g;
  };
  double low = -2, high = 2;
  for (int i = 0; i < 100; ++i) (at_wall(0.5 * (low + high)) < height_m ? low : high) = 0.5 * (low + high);
  return 0.5 * (low + high);
}

/// One photon on the wall, as a map of its own.
PhotonMap::Contents photon_at(double y_m, double z_m, const std::array<float, 3> &normal) {
  PhotonMap::Contents c;
  c.order = {0};
  c.x_m = {static_cast<float>(wall_m)}, c.y_m = {static_cast<float>(y_m)}, c.z_m = {static_cast<float>(z_m)};
  c.normal = {photon_twin::pack_normal(normal[0], normal[1], normal[2])};
  c.power_W = {2.5f};
  return c;
}

// oracle: the pinhole's projection; through the medium along the catenary that ends at the photon (level across: the
//         path's way in plan is the straight line to it)
// tolerance: ends of paths lie anywhere in their pixels: the photon's own is within 2^(1/2) of a pixel, the middle of
// the
//         nearest one's pixel within 2^(1/2) + 2^(-1/2) of the photon; on average over 40 photons within 5 x
//         0.6/40^(1/2)
TEST(PhotonPicture, APhotonIsSeenAlongTheEyesPath) {
  for (const bool bent : {false, true}) {
    const std::vector<GatherPoint> ends = ends_of(wall_scene(bent));
    const double tangent = 2 * std::tan(20 * M_PI / 180) / columns;
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> height(-0.3, 1.8);
    double off = 0;
    for (int i = 0; i < 40; ++i) {
      const double z = height(engine);
      PhotonPicture picture(ends, columns, 1, 1);
      picture.show(photon_at(0, z, {-1, 0, 0}), 1);
      ASSERT_EQ(picture.shown(), 1u) << z;
      const auto lit = std::max_element(picture.power().begin(), picture.power().end());
      EXPECT_FLOAT_EQ(*lit, 2.5f);
      const auto pixel = static_cast<int>(lit - picture.power().begin());
      const double row = pixel / columns + 0.5, expected = rows / 2.0 - slope_to(z, bent) / tangent;
      EXPECT_NEAR(row, expected, 2.13) << z << bent;
      EXPECT_NEAR(pixel % columns + 0.5, columns / 2.0, 2.13) << z << bent;
      off += (row - expected) / 40;
    }
    EXPECT_NEAR(off, 0, 0.5) << bent;
    // The bent picture is another one: the same photon is 14 pixels away.
    EXPECT_GT(std::abs(slope_to(1, true) - slope_to(1, false)) / tangent, 10);
  }
}

// oracle: what is behind the wall, beside the picture or far from every path has no pixel; the share that is drawn is
//         the share asked for
// tolerance: none; 5 binomial errors
TEST(PhotonPicture, HiddenPhotonsAndTheShareThatIsDrawn) {
  const std::vector<GatherPoint> ends = ends_of(wall_scene(false));
  for (const auto &[y, z, side] :
       {std::tuple{0.0, 1.0, 1.0f}, {4.0, 1.0, -1.0f}, {0.0, 4.5, -1.0f}, {0.0, -4.0, -1.0f}}) {
    PhotonPicture picture(ends, columns, 1, 1);
    picture.show(photon_at(y, z, {side, 0, 0}), 1);
    EXPECT_EQ(picture.shown(), 0u) << y << " " << z << " " << side;
  }
  PhotonMap::Contents many;
  std::mt19937 engine(7);
  std::uniform_real_distribution<float> inside(-1.0f, 1.0f);
  for (unsigned i = 0; i < 40000; ++i) {
    const PhotonMap::Contents one =
        photon_at(static_cast<double>(inside(engine)), 1 + static_cast<double>(inside(engine)), {-1, 0, 0});
    many.order.push_back(i), many.normal.push_back(one.normal[0]), many.power_W.push_back(1);
    many.x_m.push_back(one.x_m[0]), many.y_m.push_back(one.y_m[0]), many.z_m.push_back(one.z_m[0]);
  }
  PhotonPicture all(ends, columns, 1, 1), part(ends, columns, 1, 1);
  all.show(many, 40000), part.show(many, 10000);
  EXPECT_EQ(all.shown(), 40000u);
  EXPECT_NEAR(static_cast<double>(part.shown()), 10000, 5 * std::sqrt(7500.0));
  float counted = 0;
  for (const float n : all.counts()) counted += n;
  EXPECT_FLOAT_EQ(counted, 40000);
}

// oracle: a whole render: the dots that are seen, all of a lit wall's photons (the picture holds all of it that is lit
//         within the view), spread as the light of a point does: E proportional to cos^3
// tolerance: 5 Poisson errors of each of 12 squares of 20 x 20 pixels about the middle
TEST(PhotonPicture, OfARender) {
  RoomOptions options;
  options.size = {columns, rows};
  options.photon_map = 1000000;
  const RoomScene scene = wall_scene(false);
  const RoomPicture picture = render_room(scene, options, shared_device());
  ASSERT_TRUE(picture.photon_map);
  const std::vector<float> &counts = picture.photon_map->channels.at("photon_count");
  const double tangent = 2 * std::tan(20 * M_PI / 180) / columns;
  double all = 0;
  for (const float n : counts) all += static_cast<double>(n);
  const double emitted = static_cast<double>(picture.report.photons.photons) / picture.report.passes;
  ASSERT_GT(all, 500);
  for (int by = 0; by < 3; ++by)
    for (int bx = 0; bx < 4; ++bx) {
      double found = 0, expected = 0;
      for (int y = 15 + 20 * by; y < 35 + 20 * by; ++y)
        for (int x = 20 + 20 * bx; x < 40 + 20 * bx; ++x) {
          found += static_cast<double>(counts[static_cast<std::size_t>(y * columns + x)]);
          // The light stands 5 m before the wall, the eye 6 m: solid angle of the pixel's patch at the light over 4 pi.
          const double across = 6 * (x + 0.5 - columns / 2.0) * tangent, up = 6 * (rows / 2.0 - y - 0.5) * tangent;
          expected += emitted * std::pow(6 * tangent, 2) * 5 / std::pow(25 + across * across + up * up, 1.5) / 4 / M_PI;
        }
      EXPECT_NEAR(found, expected, 5 * std::sqrt(expected)) << bx << by;
    }
}

}  // namespace
}  // namespace greenray
