// Every kernel of the photon side on a handful of photons: what `ctest -L oclgrind` runs under the simulator, which
// finds reads and writes outside of buffers, races and uninitialised values. On a real device it is a quick test by
// itself.
#include <gtest/gtest.h>

#include "compute/photon_gather.hpp"
#include "compute/sampling_probe.hpp"
#include "support_code/photon_scenes.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

// oracle: the host twin's words and samplers
// tolerance: sine and cosine of the device are good to 4 ulp of 1
TEST(TinyPhotons, Samples) {
  for (auto kind : {photon_twin::SAMPLE_CONE, photon_twin::SAMPLE_GGX, photon_twin::SAMPLE_ROULETTE}) {
    const auto device = device_samples(shared_device(), kind, 0.4f, 5, 3), host = host_samples(kind, 0.4f, 5, 3);
    for (std::size_t i = 0; i < 5; ++i)
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(device[i][k], host[i][k], 5e-6);
  }
}

// oracle: every photon is filed once, and a ball that holds the room finds those of its side
// tolerance: none
TEST(TinyPhotons, FiledAndFound) {
  const Photons photons = shuffled(photons_in_room(60, 2, 5), 1);
  const std::vector<GatherPoint> points = points_in_room(3, 2);
  for (int lanes : {8, 1}) {
    PhotonMap map(shared_device(lanes), {photons.records.size(), 2, 0, 17});
    map.upload(photons.records, photons.power_W);
    map.build(photons.records.size(), bounds_of(photons.records), 1.3);
    ASSERT_EQ(map.filed(), photons.records.size());
    PhotonGather gather(shared_device(lanes), 2, {GATHER_CONE, true, 0, 2});
    gather.set_points(points);
    gather.within(map, gather_settings(20, 1, 180));
    for (const Gathered &g : gather.read().gathered) EXPECT_EQ(g.count, 60);
    gather.within(map, gather_settings(20, 0.99, 180),
                  std::vector<float>{20, 1, 0.1f});  // the kernel that tells sides apart
    EXPECT_EQ(gather.read().gathered[0].count, 60);
    GatherSettings settings = gather_settings(20, 1, 180);
    settings.guess_m = 0.5f;
    settings.nearest = 7;
    gather.nearest(map, settings);
    for (const Gathered &g : gather.read().gathered) EXPECT_EQ(g.count, 6);
  }
}

// oracle: a ball that holds the room finds all photons, one that holds no place finds none
// tolerance: none
TEST(TinyPhotons, DenseCell) {
  const Photons photons = photons_in_room(1100, 1, 5);
  const std::vector<GatherPoint> points = points_in_room(2, 2);
  PhotonMap map(shared_device(), {photons.records.size(), 1, 0, 0});
  map.upload(photons.records, photons.power_W);
  map.build(photons.records.size(), bounds_of(photons.records), 30);
  PhotonGather gather(shared_device(), 1, {GATHER_FLAT, false, 0, 2});
  gather.set_points(points);
  gather.within(map, gather_settings(20, 1, 180));
  for (const Gathered &g : gather.read().gathered) EXPECT_EQ(g.count, 1100);
  gather.within(map, gather_settings(1e-6, 1, 180));
  for (const Gathered &g : gather.read().gathered) EXPECT_EQ(g.count, 0);
  GatherSettings settings = gather_settings(20, 1, 180);
  settings.guess_m = 20;
  settings.nearest = 7;
  gather.nearest(map, settings);
  for (const Gathered &g : gather.read().gathered) EXPECT_EQ(g.count, 6);
}

}  // namespace
}  // namespace greenray
