// The kernels of rooms on a handful of paths: what `ctest -L oclgrind` runs under the simulator. On a real device they
// are quick tests by themselves, of closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "compute/photon_map_state.hpp"
#include "compute/room_tracer.hpp"
#include "render/room.hpp"
#include "render/room_looks.hpp"
#include "scene/bvh.hpp"
#include "support_code/twin_traits.hpp"
#include "twin/photon_twin.hpp"

namespace greenray {
namespace {

/// A scene on the device, two wavelengths.
struct TinyRoom {
  explicit TinyRoom(const std::string &rows, int lanes = 0)
      : scene(parse_room("tiny.toml",
                         "greenray = 1\n[camera]\nfrom = [0, 0, 3]\nto = [0, 0, 0]\nup = [0, 1, 0]\n"
                         "[spectrum]\nsamples = 2\n" +
                             rows)),
        looks(room_looks(scene)),
        tracer(shared_device(lanes), build_surface_tree(scene.surfaces, SurfaceScene::lanes_for(*shared_device(lanes))),
               room_air(scene, looks.wavelength_nm, false), looks) {}
  RoomScene scene;
  RoomLooks looks;
  RoomTracer tracer;
};

const std::string floor_quad =
    "[[quad]]\ncorner = [-1, -1, 0]\nedge_u = [2, 0, 0]\nedge_v = [0, 2, 0]\nreflectance = 0.5\n";

// oracle: in the middle the floor holds all of a disc, on its edge half, in its corner a quarter
// tolerance: 16 looks: 0.1
TEST(TinyRooms, CoverOfAMiddleAnEdgeAndACorner) {
  for (const int lanes : {0, 1}) {
    TinyRoom room(floor_quad + "[[light]]\nkind = \"point\"\nfrom = [0, 0, 2]\npower_W = 1\n", lanes);
    const unsigned up = photon_twin::pack_normal(0, 0, 1);
    const std::vector<GatherPoint> points{{{0.3f, 0.1f, 0}, up}, {{0.999f, 0.1f, 0}, up}, {{0.999f, 0.999f, 0}, up}};
    const std::vector<float> radii{0.2f, 0.3f, 0.3f};
    const std::vector<room_twin::Cover> found = room.tracer.cover(points, radii, 0.25, 0.5);
    ASSERT_EQ(found.size(), 3u);
    EXPECT_EQ(found[0].whole, 1);
    EXPECT_NEAR(static_cast<double>(found[1].whole), 0.5, 0.1);
    EXPECT_NEAR(static_cast<double>(found[2].whole), 0.25, 0.1);
  }
}

// oracle: a lamp of 1 W and 4 m^2 seen face on: power/(pi area) in each wavelength, per nm; beside it nothing
// tolerance: 1e-5, float
TEST(TinyRooms, LampsAreSeen) {
  TinyRoom room(
      "[[quad]]\nname = \"lamp\"\ncorner = [-1, -1, 0]\nedge_u = [2, 0, 0]\nedge_v = [0, 2, 0]\nreflectance = 0\n"
      "[[light]]\nkind = \"area\"\nsurface = \"lamp\"\npower_W = 1\n");
  room_twin::EyeCamera camera{};
  camera.place[2] = 3, camera.ahead[2] = -1, camera.up[1] = 1, camera.right[0] = 1;
  camera.pixel_tangent = 0.5f, camera.centre_column = 2, camera.centre_row = 0.5f;
  camera.width = 4, camera.rows = 1, camera.samples = 3, camera.most_bounces = 3, camera.seed = 1;
  camera.pixel_tangent = 0.3f;  // columns 1 and 2 look at the lamp, 0 and 3 may pass it
  const std::vector<float> seen = room.tracer.see_lamps(camera, {1, 2});
  camera.pixel_tangent = 2.0f;
  const std::vector<float> beside = room.tracer.see_lamps(camera, {0, 3});
  const int row = room.looks.lights[0].power;
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t w = 0; w < 2; ++w) {
      const double expected =
          static_cast<double>(room.looks.spectra[static_cast<std::size_t>(row) * 2 + w]) / (4 * M_PI);
      EXPECT_NEAR(static_cast<double>(seen[2 * i + w]) / expected, 1, 1e-5);
      EXPECT_EQ(beside[2 * i + w], 0);
    }
  // The same paths one by one, of a list of pixels.
  camera.pixel_tangent = 0.3f;
  const EyeBand band = room.tracer.see(camera, std::vector<int>{1, 2});
  ASSERT_EQ(band.samples.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(static_cast<double>(band.radiance[2 * i]), static_cast<double>(seen[2 * (i / 3)]), 1e-7);
}

/// A spot at (0, 0, 2) that shines down its cone of 20 degrees, onto a mirror of 0.2 m x 0.2 m at z = 1, which fills
/// the middle of it, and a floor around; a ceiling at z = 3 catches what comes back.
const std::string mirror_rows =
    "[[material]]\nname = \"mirror\"\nkind = \"mirror\"\nreflectance = 0.8\n"
    "[[quad]]\ncorner = [-0.1, -0.1, 1]\nedge_u = [0.2, 0, 0]\nedge_v = [0, 0.2, 0]\nmaterial = \"mirror\"\n"
    "[[quad]]\ncorner = [-2, -2, 3]\nedge_u = [0, 4, 0]\nedge_v = [4, 0, 0]\nreflectance = 0\n" +
    floor_quad + "[[light]]\nkind = \"spot\"\nfrom = [0, 0, 2]\nto = [0, 0, 0]\npower_W = 1\ncone_deg = 20\n";

// oracle: a direction meets the mirror where it stays within 0.1 m of the axis in x and in y after 1 m; cells are 64
//         rings of equal solid angle by 64 sectors, so that a ring within 0.1 m all round is all mirror, one beyond
//         0.1 x 2^(1/2) m none
// tolerance: none
TEST(TinyRooms, CellsThatMeetTheMirrorAreMarked) {
  TinyRoom room(mirror_rows);
  std::vector<room_twin::LightProjection> projection(1);
  projection[0].bits[0] = projection[0].bits[1] = 6;
  share_photons(room.looks, 16), room.tracer.set_lights(room.looks.lights);
  PhotonBatch batch;
  batch.photons = 16, batch.most_bounces = 4, batch.pass = 9;
  const std::vector<int> counts = room.tracer.mark_cells(batch, projection, 1);
  ASSERT_EQ(counts.size(), 4096u);
  const double versine = 1 - std::cos(10 * M_PI / 180);
  for (int cell = 0; cell < 4096; ++cell) {
    const auto radius_m = [&](double share) {
      const double cosine = 1 - versine * share;
      return std::sqrt(1 - cosine * cosine) / cosine;
    };
    const int ring = cell % 64;
    if (radius_m((ring + 1) / 64.0) < 0.1) {
      EXPECT_EQ(counts[static_cast<std::size_t>(cell)], 1) << cell;
    }
    if (radius_m(ring / 64.0) > 0.1 * std::sqrt(2)) {
      EXPECT_EQ(counts[static_cast<std::size_t>(cell)], 0) << cell;
    }
  }
}

// oracle: what leaves the spot at a slope s lands on the ceiling 3 m of way on, at 3 s from the axis: within 3 x 0.1 m
//         in x and y; the power is that of the mirror's share of the cone, times 0.8
// tolerance: 5 Poisson errors of the photons that land
TEST(TinyRooms, AimedPhotonsLandWhereTheMirrorThrowsThem) {
  TinyRoom room(mirror_rows);
  constexpr std::uint32_t photons = 60;
  share_photons(room.looks, photons), room.tracer.set_lights(room.looks.lights);
  AimedLights aim;
  aim.lights.resize(1);
  aim.lights[0].bits[0] = aim.lights[0].bits[1] = 6;
  for (int cell = 0; cell < 4096; ++cell)
    if (cell % 64 < 42) aim.cells.push_back(cell);  // rings up to 0.1 x 2^(1/2) m, the mirror's corners
  const double marked = static_cast<double>(aim.cells.size()) / 4096;
  aim.lights[0].marked = static_cast<int>(aim.cells.size());
  aim.lights[0].explored = 0.1f;
  for (int cell = 0; cell < 4096; ++cell)
    aim.weights.push_back(static_cast<float>(1 / (0.1 + (cell % 64 < 42 ? 0.9 / marked : 0))));
  room.tracer.set_aim(aim);
  PhotonBatch batch;
  batch.photons = photons, batch.most_bounces = 4, batch.chunk = 8, batch.slots = {8, 0};
  PhotonMap map(shared_device(), {batch.chunks() * 8, 2, 0, 0});
  PhotonTotals totals;
  room.tracer.store_caustics(batch, map, totals);
  std::vector<Photon> records(batch.chunks() * 8);
  std::vector<float> powers(2 * records.size());
  map.state().records.read(records.data(), records.size());
  map.state().record_power_W.read(powers.data(), powers.size());
  double power = 0;
  std::uint64_t landed = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Photon &photon = records[i];
    if (photon.tags == 0) continue;
    EXPECT_EQ(PHOTON_KIND(photon.tags), PHOTON_CAUSTIC);
    EXPECT_EQ(photon.place_m[2], 3);
    EXPECT_LE(std::max(std::abs(photon.place_m[0]), std::abs(photon.place_m[1])), 0.3001f);
    power += static_cast<double>(powers[2 * i]), ++landed;
  }
  EXPECT_EQ(landed, totals.stored[1]);
  ASSERT_GT(landed, 20u);
  // Solid angle of a square of half side h seen from 1 m above its middle: 4 asin(h^2/(1 + h^2)).
  const double share = 4 * std::asin(0.01 / 1.01) / (2 * M_PI * (1 - std::cos(10 * M_PI / 180)));
  const auto row = static_cast<std::size_t>(room.looks.lights[0].power);
  const double expected = 0.8 * share * static_cast<double>(room.looks.spectra[2 * row]);
  EXPECT_NEAR(power / expected, 1, 5 / std::sqrt(static_cast<double>(landed)));
  map.build(records.size(), Bounds{{-1, -1, 0}, {1, 1, 3}}, 0.3);
  EXPECT_EQ(map.filed(), landed);
}

}  // namespace
}  // namespace greenray
