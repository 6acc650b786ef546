// Filing photons on a device: the map is the sorted records.
#include "compute/photon_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <random>

#include "support_code/photon_scenes.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

/// Cell of a place, worked out here from the grid's meaning alone.
int cell_by_hand(const PhotonGrid &g, const Photon &p) {
  int cell[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float t = (p.place_m[axis] - g.origin_m[axis]) * g.per_m;
    const int n = g.cells[axis], whole = static_cast<int>(std::floor(t));
    cell[axis] = g.wrap && axis > 0 ? ((whole % n) + n) % n : std::clamp(whole, 0, n - 1);
  }
  return (cell[2] * g.cells[1] + cell[1]) * g.cells[0] + cell[0];
}

/// Where std::sort puts a record: (cell, id, bounce).
using Key = std::tuple<int, unsigned, unsigned>;
Key key_by_hand(const PhotonGrid &g, const Photon &p) { return {cell_by_hand(g, p), p.id, PHOTON_BOUNCE(p.tags)}; }

/// The map that std::sort makes of the records.
std::vector<unsigned> order_by_hand(const PhotonGrid &g, const Photons &photons) {
  std::vector<unsigned> order;
  std::vector<Key> keys(photons.records.size());
  for (unsigned i = 0; i < photons.records.size(); ++i) {
    const Photon &p = photons.records[i];
    if (PHOTON_KIND(p.tags) == PHOTON_NONE || !std::isfinite(p.place_m[0])) continue;
    order.push_back(i);
    keys[i] = key_by_hand(g, p);
  }
  std::sort(order.begin(), order.end(), [&](unsigned a, unsigned b) { return keys[a] < keys[b]; });
  return order;
}

/// The order of a map with dense cells, of 1025 photons and more, put back into that of emission: they have an order of
/// their own.
std::vector<unsigned> with_dense_cells_by_emission(const PhotonMap::Contents &c, const PhotonGrid &g,
                                                   const Photons &photons) {
  std::vector<unsigned> order = c.order;
  for (std::size_t k = 0; k + 1 < c.cell_start.size(); ++k)
    if (c.cell_start[k + 1] - c.cell_start[k] >= 1025)
      std::sort(order.begin() + c.cell_start[k], order.begin() + c.cell_start[k + 1], [&](unsigned a, unsigned b) {
        return key_by_hand(g, photons.records[a]) < key_by_hand(g, photons.records[b]);
      });
  return order;
}

PhotonMap::Contents filed(const Photons &photons, double cell_m, int local_size = 0, int chunk = 0,
                          const std::shared_ptr<Device> &device = shared_device()) {
  PhotonMap map(device, {photons.records.size(), photons.waves, local_size, chunk});
  map.upload(photons.records, photons.power_W);
  map.build(photons.records.size(), bounds_of(photons.records), cell_m);
  return map.read();
}

void expect_same_map(const PhotonMap::Contents &a, const PhotonMap::Contents &b) {
  EXPECT_EQ(a.order, b.order);
  EXPECT_EQ(a.cell_start, b.cell_start);
  EXPECT_EQ(a.x_m, b.x_m);
  EXPECT_EQ(a.z_m, b.z_m);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.power_W, b.power_W);
}

void expect_sorted_records(const Photons &photons, const Bounds &bounds, double cell_m, int lanes = 0) {
  PhotonMap map(shared_device(lanes), {photons.records.size(), photons.waves, 0, 0});
  map.upload(photons.records, photons.power_W);
  map.build(photons.records.size(), bounds, cell_m);
  const PhotonMap::Contents c = map.read();
  const std::vector<unsigned> expected = order_by_hand(map.grid(), photons);
  const auto waves = static_cast<std::size_t>(photons.waves);
  ASSERT_EQ(map.filed(), expected.size());
  EXPECT_EQ(with_dense_cells_by_emission(c, map.grid(), photons), expected) << cell_m;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Photon &p = photons.records[c.order[i]];
    ASSERT_EQ(c.x_m[i], p.place_m[0]);
    ASSERT_EQ(c.y_m[i], p.place_m[1]);
    ASSERT_EQ(c.z_m[i], p.place_m[2]);
    ASSERT_EQ(c.normal[i], p.normal);
    for (std::size_t w = 0; w < waves; ++w)
      ASSERT_EQ(c.power_W[w * expected.size() + i], photons.power_W[c.order[i] * waves + w]);
    const int cell = cell_by_hand(map.grid(), p);
    ASSERT_LE(c.cell_start[static_cast<std::size_t>(cell)], static_cast<int>(i));
    ASSERT_GT(c.cell_start[static_cast<std::size_t>(cell) + 1], static_cast<int>(i));
  }
}

// oracle: std::sort by (cell, id, bounce), cells from the definition of the grid
// tolerance: none
TEST(PhotonMap, IsTheRecordsSortedByCellThenEmission) {
  for (int waves : {1, 2, 3, 9}) {
    const Photons photons = photons_in_room(20000, waves, 7);
    for (double cell_m : {0.31, 0.02, 40.0}) expect_sorted_records(photons, bounds_of(photons.records), cell_m);
  }
}

// oracle: the same, records in any order, so that every cell is sorted by emission, the one of all photons too
// tolerance: none
TEST(PhotonMap, SortsCellsByEmission) {
  const Photons photons = shuffled(photons_in_room(20000, 1, 17), 3);
  for (double cell_m : {0.31, 0.02, 40.0}) expect_sorted_records(photons, bounds_of(photons.records), cell_m);
}

// oracle: the same; photons outside of the box are filed in its outermost cells, or wrapped around
// tolerance: none
TEST(PhotonMap, FilesWhatLiesOutsideTheBox) {
  const Photons photons = photons_in_room(20000, 1, 27);
  const Bounds inner{{0, 3, 11}, {1, 4, 12}};
  for (double cell_m : {0.31, 0.01}) expect_sorted_records(photons, inner, cell_m);
}

// oracle: one stable order exists, so chunks, work-groups and threads cannot matter
// tolerance: none
TEST(PhotonMap, SameBitsForAnyChunkWorkGroupAndThreads) {
  const Photons photons = photons_in_room(30000, 3, 11);
  DeviceOptions one_thread = device_options();
  one_thread.threads = 1;
  for (double cell_m : {0.2, 1.5, 40.0}) { /* no dense cells, some, one that holds everything */
    const PhotonMap::Contents reference = filed(photons, cell_m);
    for (int local_size : {1, 3, 16})
      for (int chunk : {97, 1024, 40000}) expect_same_map(filed(photons, cell_m, local_size, chunk), reference);
    expect_same_map(filed(photons, cell_m, 0, 0, open_device(one_thread)), reference);
  }
}

// oracle: the map of the same photons in the order of their emission
// tolerance: none
TEST(PhotonMap, TheOrderOfTheRecordsDoesNotMatter) {
  const Photons photons = photons_in_room(15000, 2, 3);
  const Photons mixed = shuffled(photons, 99);
  for (double cell_m : {0.15, 1.5, 40.0}) {
    const PhotonMap::Contents a = filed(photons, cell_m), b = filed(mixed, cell_m);
    EXPECT_EQ(a.cell_start, b.cell_start);
    EXPECT_EQ(a.x_m, b.x_m);
    EXPECT_EQ(a.y_m, b.y_m);
    EXPECT_EQ(a.power_W, b.power_W);
    for (std::size_t i = 0; i < a.order.size(); ++i) {
      const Photon &pa = photons.records[a.order[i]], &pb = mixed.records[b.order[i]];
      ASSERT_EQ(std::memcmp(&pa, &pb, sizeof pa), 0) << i;
    }
  }
}

// oracle: the same; two records of one chunk change places, which only a look within the chunk can tell
// tolerance: none
TEST(PhotonMap, TwoRecordsOutOfOrder) {
  Photons photons = photons_in_room(900, 1, 51);
  for (Photon &p : photons.records) p.place_m[0] = p.place_m[1] = p.place_m[2] = 0.5f; /* all in one cell */
  std::swap(photons.records[700], photons.records[702]);
  std::swap(photons.power_W[700], photons.power_W[702]);
  for (const int lanes : {1, 8}) expect_sorted_records(photons, {{0, 0, 0}, {1, 1, 1}}, 0.3, lanes);
}

// oracle: the records without their empty slots
// tolerance: none
TEST(PhotonMap, LeavesOutEmptySlotsAndPlacesThatAreNoNumbers) {
  const Photons photons = photons_in_room(5000, 1, 5);
  Photons holes;
  holes.waves = 1;
  for (std::size_t i = 0; i < photons.records.size(); ++i) {
    holes.records.push_back(photons.records[i]), holes.power_W.push_back(photons.power_W[i]);
    if (i % 3 == 0) holes.records.push_back(Photon{}), holes.power_W.push_back(1e9f);
    if (i % 100 == 0) {
      Photon lost = photons.records[i];
      lost.place_m[i % 3] = std::numeric_limits<float>::quiet_NaN();
      holes.records.push_back(lost), holes.power_W.push_back(1e9f);
    }
  }
  const PhotonMap::Contents a = filed(photons, 0.3), b = filed(holes, 0.3);
  EXPECT_EQ(a.x_m, b.x_m);
  EXPECT_EQ(a.power_W, b.power_W);
  EXPECT_EQ(a.cell_start, b.cell_start);
}

TEST(PhotonMap, EmptyAndRefusals) {
  PhotonMap map(shared_device(), {10, 1, 0, 0});
  map.build(0, {}, 1);
  EXPECT_EQ(map.filed(), 0u);
  const Photons photons = photons_in_room(11, 1, 5);
  EXPECT_ANY_THROW(map.upload(photons.records, photons.power_W));
  EXPECT_ANY_THROW(map.build(11, {}, 1));
  EXPECT_ANY_THROW(map.build(1, {}, 0));
}

}  // namespace
}  // namespace greenray
