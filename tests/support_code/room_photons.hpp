// Where the photons of a scene land, read back from the device.
#pragma once
#include "compute/room_tracer.hpp"
#include "render/room.hpp"
#include "render/room_looks.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {

struct LandedPhotons {
  PhotonMap::Contents map;  // of everything that is no caustic
  PhotonTotals totals;
  std::size_t count() const { return map.x_m.size(); }
  Triple place(std::size_t i) const {
    return {static_cast<double>(map.x_m[i]), static_cast<double>(map.y_m[i]), static_cast<double>(map.z_m[i])};
  }
};

inline LandedPhotons land_photons(const RoomScene &scene, std::uint32_t photons, bool straight = false,
                                  std::uint32_t seed = 1, int chunk = 64) {
  const auto device = shared_device();
  RoomLooks looks = room_looks(scene);
  const AirTable air = room_air(scene, looks.wavelength_nm, straight);
  const SurfaceTree tree = build_surface_tree(scene.surfaces, SurfaceScene::lanes_for(*device));
  share_photons(looks, photons, looks.light_power_W_nm);
  RoomTracer tracer(device, tree, air, looks);
  PhotonBatch batch;
  batch.seed = seed, batch.photons = photons, batch.chunk = chunk, batch.most_bounces = scene.photons.most_bounces;
  const int slots = 4 * chunk + 40;
  batch.slots = {slots, slots};
  const std::size_t records = batch.chunks() * static_cast<std::size_t>(slots);
  PhotonMap diffuse(device, {records, static_cast<int>(looks.waves()), 0, 0}),
      caustic(device, {records, static_cast<int>(looks.waves()), 0, 0});
  LandedPhotons landed;
  std::array<int, 2> most{};
  EXPECT_TRUE(tracer.store(batch, diffuse, caustic, landed.totals, most)) << "more than four landings a photon";
  Bounds bounds;
  for (std::size_t a = 0; a < 3; ++a)
    bounds.low_m[a] = static_cast<double>(tree.bounds.low[a]),
    bounds.high_m[a] = static_cast<double>(tree.bounds.high[a]);
  diffuse.build(records, bounds, 0.1);
  landed.map = diffuse.read();
  return landed;
}

}  // namespace greenray
