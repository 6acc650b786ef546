// Gathering from a photon map on a device, in float, against brute force: counts are exact.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "compute/photon_gather.hpp"
#include "compute/photon_map.hpp"
#include "support_code/photon_scenes.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

/// Who is inside, in the arithmetic of the device: float, no contraction, the same order of sums.
struct Near {
  std::vector<std::pair<float, unsigned>> photons;  // (d^2 with the squash, record)
};
Near near_by_hand(const Photons &photons, const GatherPoint &q, const GatherSettings &s) {
  Near near;
  const auto component = [](unsigned packed, int k) {
    return static_cast<float>(static_cast<int>(packed << (22 - 10 * k)) >> 22);
  };
  const float nx = component(q.normal, 0) * (1.0f / 511), ny = component(q.normal, 1) * (1.0f / 511),
              nz = component(q.normal, 2) * (1.0f / 511);
  for (unsigned i = 0; i < photons.records.size(); ++i) {
    const Photon &p = photons.records[i];
    if (PHOTON_KIND(p.tags) == PHOTON_NONE) continue;
    const float dx = p.place_m[0] - q.place_m[0], dy = p.place_m[1] - q.place_m[1], dz = p.place_m[2] - q.place_m[2];
    const float cosine = component(p.normal, 0) * nx + component(p.normal, 1) * ny + component(p.normal, 2) * nz;
    if (!(cosine >= s.facing * 511)) continue;
    const float height = dx * nx + dy * ny + dz * nz;
    near.photons.emplace_back(((dx * dx + dy * dy) + dz * dz) + s.squash * (height * height), i);
  }
  std::sort(near.photons.begin(), near.photons.end());
  return near;
}

/// Photons below a squared distance.
int count_inside(const Near &near, float r2) {
  return static_cast<int>(
      std::count_if(near.photons.begin(), near.photons.end(), [&](const auto &p) { return p.first < r2; }));
}

double kernel_by_hand(GatherKernel kernel, double d2, double r2) {
  const double pi = std::acos(-1.0), x = std::sqrt(d2 / r2);
  if (kernel == GATHER_CONE) return (1 - x / 1.1) / ((1 - 2 / (3 * 1.1)) * pi * r2);
  if (kernel == GATHER_EPANECHNIKOV) return (1 - x * x) * 2 / (pi * r2);
  return 1 / (pi * r2);
}

// oracle: brute force over all photons, distances in float as the device's, sums in double
// tolerance: counts none; sums of a few hundred floats in 8 lanes: 100 roundings of 6e-8, relative
TEST(PhotonGather, RadiusAgainstBruteForce) {
  const Photons photons = photons_in_room(20000, 3, 21);
  const std::vector<GatherPoint> points = points_in_room(300, 4);
  for (int lanes : {1, 4, 8})
    for (GatherKernel kernel : {GATHER_FLAT, GATHER_CONE, GATHER_EPANECHNIKOV})
      for (double cell_m : {0.3, 0.11, 0.8}) {
        PhotonMap map(shared_device(lanes), {photons.records.size(), photons.waves, 0, 0});
        map.upload(photons.records, photons.power_W);
        map.build(photons.records.size(), bounds_of(photons.records), cell_m);
        /* cells of 0.11 m: a ball of all sides, which is another kernel */
        const GatherSettings settings = cell_m == 0.11 ? gather_settings(0.3, 1, 180) : gather_settings(0.3);
        PhotonGather gather(shared_device(lanes), photons.waves, {kernel, true, 0, 8});
        gather.set_points(points);
        gather.within(map, settings);
        const GatherAnswers answers = gather.read();
        const float r2 = settings.radius_m * settings.radius_m;
        for (std::size_t q = 0; q < points.size(); ++q) {
          const Near near = near_by_hand(photons, points[q], settings);
          double sum[3] = {0, 0, 0}, inner = 0, squares = 0;
          int count = 0;
          for (const auto &[d2, i] : near.photons) {
            if (d2 >= r2) break;
            ++count;
            double whole = 0;
            for (std::size_t w = 0; w < 3; ++w) {
              const double power = static_cast<double>(photons.power_W[i * 3 + w]);
              sum[w] += kernel_by_hand(kernel, d2, r2) * power;
              whole += power;
            }
            if (d2 < 0.5f * r2) inner += kernel_by_hand(kernel, d2, r2 / 2) * whole;
            squares += std::pow(kernel_by_hand(kernel, d2, r2) * whole, 2);
          }
          ASSERT_EQ(answers.gathered[q].count, count) << q << " lanes " << lanes << " cell " << cell_m;
          for (std::size_t w = 0; w < 3; ++w) ASSERT_NEAR(answers.irradiance[q * 3 + w], sum[w], 6e-6 * sum[w] + 1e-9);
          ASSERT_NEAR(answers.spread[q].inner_W_m2, inner, 6e-6 * inner + 1e-9);
          ASSERT_NEAR(answers.spread[q].variance_W2_m4, squares, 1e-5 * squares + 1e-9);
        }
      }
}

// oracle: brute force, as above: photons all through the air, so that those high over the surface tell a flattened ball
//         from a sphere, and one of normals that tells sides from one that does not
// tolerance: none
TEST(PhotonGather, FlattenedBallAgainstBruteForce) {
  Photons photons = photons_in_room(20000, 1, 61);
  std::mt19937 engine(62);
  std::uniform_real_distribution<float> unit(0, 1);
  for (Photon &p : photons.records) {
    for (float &x : p.place_m) x = unit(engine);
    p.normal = photon_twin::pack_normal(unit(engine) - 0.5f, unit(engine) - 0.5f, 1);
  }
  std::vector<GatherPoint> points;
  for (int i = 0; i < 100; ++i)
    points.push_back({{unit(engine), unit(engine), unit(engine)},
                      photon_twin::pack_normal(unit(engine) - 0.5f, unit(engine) - 0.5f, 1)});
  for (const int lanes : {1, 8})
    for (const double flatness : {1.0, 0.5, 0.25, 0.05}) {
      PhotonMap map(shared_device(lanes), {photons.records.size(), 1, 0, 0});
      map.upload(photons.records, photons.power_W);
      map.build(photons.records.size(), bounds_of(photons.records), 0.1);
      GatherSettings settings = gather_settings(0.15, flatness, 60);
      PhotonGather gather(shared_device(lanes), 1, {GATHER_FLAT, false, 0, 4});
      gather.set_points(points);
      gather.within(map, settings);
      const GatherAnswers within = gather.read();
      settings.radius_m = 10, settings.guess_m = 0.15f, settings.nearest = 40;
      gather.nearest(map, settings);
      const GatherAnswers nearest = gather.read();
      int met = 0;
      for (std::size_t q = 0; q < points.size(); ++q) {
        const Near near = near_by_hand(photons, points[q], settings);
        ASSERT_EQ(within.gathered[q].count, count_inside(near, 0.15f * 0.15f)) << q << " flatness " << flatness;
        ASSERT_EQ(nearest.gathered[q].radius_m, std::sqrt(near.photons[39].first)) << q << " flatness " << flatness;
        met += within.gathered[q].count;
      }
      EXPECT_GT(met, 200);
    }
}

// oracle: a radius for each point gives what the same radius for all gives
// tolerance: none
TEST(PhotonGather, ARadiusForEachPoint) {
  const Photons photons = photons_in_room(5000, 2, 8);
  const std::vector<GatherPoint> points = points_in_room(60, 9);
  PhotonMap map(shared_device(), {photons.records.size(), 2, 0, 0});
  map.upload(photons.records, photons.power_W);
  map.build(photons.records.size(), bounds_of(photons.records), 0.25);
  PhotonGather gather(shared_device(), 2, {GATHER_CONE, true, 0, 7});
  gather.set_points(points);
  std::vector<float> radius_m;
  for (std::size_t i = 0; i < points.size(); ++i) radius_m.push_back(i % 2 ? 0.4f : 0.15f);
  gather.within(map, gather_settings(1), radius_m);
  const GatherAnswers each = gather.read();
  for (const float radius : {0.4f, 0.15f}) {
    gather.within(map, gather_settings(static_cast<double>(radius)));
    const GatherAnswers all = gather.read();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (radius_m[i] != radius) continue;
      ASSERT_EQ(each.gathered[i].count, all.gathered[i].count);
      ASSERT_EQ(each.irradiance[2 * i + 1], all.irradiance[2 * i + 1]);
      ASSERT_EQ(each.spread[i].inner_W_m2, all.spread[i].inner_W_m2);
    }
  }
}

// oracle: the same answers from work-groups, items and threads of other sizes
// tolerance: none
TEST(PhotonGather, SameBitsForAnyWorkGroupAndThreads) {
  const Photons photons = photons_in_room(9000, 4, 31);
  const std::vector<GatherPoint> points = points_in_room(101, 32);
  GatherSettings settings = gather_settings(0.5);
  settings.nearest = 40;
  const auto answers = [&](const std::shared_ptr<Device> &device, int local_size, int each) {
    PhotonMap map(device, {photons.records.size(), 4, local_size, 0});
    map.upload(photons.records, photons.power_W);
    map.build(photons.records.size(), bounds_of(photons.records), 0.25);
    PhotonGather gather(device, 4, {GATHER_EPANECHNIKOV, true, local_size, each});
    gather.set_points(points);
    gather.within(map, settings);
    std::vector<float> all = gather.read().irradiance;
    gather.nearest(map, settings);
    const GatherAnswers nearest = gather.read();
    all.insert(all.end(), nearest.irradiance.begin(), nearest.irradiance.end());
    for (const GatherSpread &s : nearest.spread) all.push_back(s.inner_W_m2), all.push_back(s.variance_W2_m4);
    return all;
  };
  const std::vector<float> reference = answers(shared_device(), 0, 8);
  for (int local_size : {1, 3, 16})
    for (int each : {1, 5, 64}) EXPECT_EQ(answers(shared_device(), local_size, each), reference);
  DeviceOptions one_thread = device_options();
  one_thread.threads = 1;
  EXPECT_EQ(answers(open_device(one_thread), 0, 8), reference);
}

// oracle: brute force: the k-th of all sorted distances, in float as the device's
// tolerance: none for the radius (its square is compared through one rounding of the root) and the count
TEST(PhotonGather, NearestAgainstBruteForce) {
  const Photons photons = photons_in_room(20000, 1, 22);
  const std::vector<GatherPoint> points = points_in_room(300, 5);
  for (int lanes : {1, 8})
    for (int k : {1, 2, 7, 150, 2000})
      for (double guess_m : {0.3, 1e-3, 5.0}) {
        PhotonMap map(shared_device(lanes), {photons.records.size(), 1, 0, 0});
        map.upload(photons.records, photons.power_W);
        map.build(photons.records.size(), bounds_of(photons.records), 0.25);
        GatherSettings settings = k == 7 ? gather_settings(30, 1, 180) : gather_settings(30); /* a ball of all sides */
        settings.nearest = k;
        settings.guess_m = static_cast<float>(guess_m);
        PhotonGather gather(shared_device(lanes), 1, {GATHER_FLAT, false, 0, 4});
        gather.set_points(points);
        gather.nearest(map, settings);
        const GatherAnswers answers = gather.read();
        for (std::size_t q = 0; q < points.size(); ++q) {
          const Near near = near_by_hand(photons, points[q], settings);
          ASSERT_GE(near.photons.size(), static_cast<std::size_t>(k));
          const float d2 = near.photons[static_cast<std::size_t>(k) - 1].first;
          ASSERT_EQ(answers.gathered[q].radius_m, std::sqrt(d2)) << q << " k " << k << " guess " << guess_m;
          ASSERT_EQ(answers.gathered[q].count, count_inside(near, d2)) << q << " k " << k;
        }
      }
}

// oracle: brute force, as above, where one cell holds thousands of photons, in a grid and in a wrapped one
// tolerance: none
TEST(PhotonGather, DenseCellsAgainstBruteForce) {
  Photons photons = photons_in_room(20000, 1, 23);
  std::vector<GatherPoint> points = points_in_room(200, 6);
  for (Photon &p : photons.records)  // the room a tenth as large, and two in three photons of it in a corner
    for (float &x : p.place_m) x *= p.id % 3 ? 0.02f : 0.1f;
  for (GatherPoint &q : points)
    for (float &x : q.place_m) x *= &q - points.data() < 100 ? 0.02f : 0.1f;
  const Bounds own = bounds_of(photons.records), wide{{-100, -100, -100}, {100, 100, 100}},
               inner{{0, 0, 0}, {.1, .2, .3}};
  for (int lanes : {1, 8})
    for (const Bounds &bounds : {own, wide, inner})
      for (double cell_m : {0.03, 0.07, 0.3}) {
        PhotonMap map(shared_device(lanes), {photons.records.size(), 1, 0, 0});
        map.upload(photons.records, photons.power_W);
        map.build(photons.records.size(), bounds, cell_m);
        GatherSettings settings = gather_settings(0.02, 1, 180);
        PhotonGather gather(shared_device(lanes), 1, {GATHER_FLAT, false, 0, 4});
        gather.set_points(points);
        gather.within(map, settings);
        const GatherAnswers within = gather.read();
        settings.radius_m = 10, settings.guess_m = 0.02f, settings.nearest = 60;
        gather.nearest(map, settings);
        const GatherAnswers nearest = gather.read();
        for (std::size_t q = 0; q < points.size(); ++q) {
          const Near near = near_by_hand(photons, points[q], settings);
          ASSERT_EQ(within.gathered[q].count, count_inside(near, 0.02f * 0.02f)) << q << " cell " << cell_m;
          ASSERT_EQ(nearest.gathered[q].radius_m, std::sqrt(near.photons[59].first)) << q << " cell " << cell_m;
          ASSERT_EQ(nearest.gathered[q].count, count_inside(near, near.photons[59].first)) << q << " cell " << cell_m;
        }
      }
}

/// Photons at places that are hard to sort or to search, and who asks about them: some photons, and places around.
struct HardCase {
  std::string name;
  Photons photons;
  std::vector<GatherPoint> points;
};
HardCase hard_case(const std::string &name, std::size_t count) {
  std::mt19937 engine(77);
  std::uniform_real_distribution<float> unit(0, 1);
  HardCase c{name, photons_in_room(count, 1, 41), {}};
  const unsigned normal = photon_twin::pack_normal(0, 0, 1);
  for (Photon &p : c.photons.records) {
    const float u = unit(engine), v = unit(engine), w = unit(engine), t = unit(engine);
    const auto put = [&](float x, float y, float z) { p.place_m[0] = x, p.place_m[1] = y, p.place_m[2] = z; };
    if (name == "one point") put(1.25f, 2.5f, 3);
    else if (name == "three points") put(u < 0.5f ? 1.0f : 1.0001f, 2, u < 0.25f ? 3.0f : 2.999f);
    else if (name == "line") put(u, 2 * u, 3 * u);
    else if (name == "axis") put(0.5f, u, 0.5f);
    else if (name == "cusp") put(u * u * u * 1e-3f, 1 + v * u * u * 0.1f, 2);
    else if (name == "two clusters")
      put(t < 0.5f ? u : 0.3f + 1e-2f * u, t < 0.5f ? v : 0.4f + 1e-2f * v, t < 0.5f ? w : 0.5f + 1e-2f * w);
    else if (name == "powers of ten") put(std::pow(10.0f, -8 * u), std::pow(10.0f, -8 * v), std::pow(10.0f, -8 * w));
    p.normal = normal;
  }
  for (int i = 0; i < 60; ++i) {
    GatherPoint q{{unit(engine), unit(engine), unit(engine)}, normal};
    const std::size_t pick = engine() % std::max<std::size_t>(count, 1);
    if (count > 0 && i % 3 > 0) /* a photon's own place, or one just beside it */
      for (int k = 0; k < 3; ++k)
        q.place_m[k] = c.photons.records[pick].place_m[k] + (i % 3 == 1 ? 0 : 1e-3f * (q.place_m[k] - 0.5f));
    c.points.push_back(q);
  }
  return c;
}

void expect_brute_force(const HardCase &c, int lanes, double cell_m, double radius_m, int k) {
  PhotonMap map(shared_device(lanes), {c.photons.records.size(), 1, 0, 0});
  map.upload(c.photons.records, c.photons.power_W);
  map.build(c.photons.records.size(), bounds_of(c.photons.records), cell_m);
  GatherSettings settings = gather_settings(radius_m, 1, 180);
  PhotonGather gather(shared_device(lanes), 1, {GATHER_FLAT, false, 0, 4});
  gather.set_points(c.points);
  gather.within(map, settings);
  const GatherAnswers within = gather.read();
  settings.radius_m = 100, settings.guess_m = static_cast<float>(radius_m), settings.nearest = k;
  gather.nearest(map, settings);
  const GatherAnswers nearest = gather.read();
  for (std::size_t q = 0; q < c.points.size(); ++q) {
    const Near near = near_by_hand(c.photons, c.points[q], settings);
    const float r = static_cast<float>(radius_m);
    ASSERT_EQ(within.gathered[q].count, count_inside(near, r * r)) << c.name << " " << q << " cell " << cell_m;
    const auto at = static_cast<std::size_t>(k) - 1;
    const float kth2 = at < near.photons.size() ? std::max(near.photons[at].first, 1e-30f) : 100.0f * 100.0f;
    ASSERT_EQ(nearest.gathered[q].radius_m, std::sqrt(kth2)) << c.name << " " << q << " k " << k << " cell " << cell_m;
    ASSERT_EQ(nearest.gathered[q].count, count_inside(near, kth2))
        << c.name << " " << q << " k " << k << " cell " << cell_m;
  }
}

// oracle: brute force over all photons, distances in float as the device's: photons that cannot be told apart by place,
// on lines, and at densities that differ by a factor of a million (two clusters: 100 times as small along each axis)
// tolerance: none
TEST(PhotonGather, HardPlacesAgainstBruteForce) {
  for (const char *name : {"one point", "three points", "line", "axis", "cusp", "two clusters", "powers of ten"})
    for (int lanes : {1, 8}) {
      const HardCase c = hard_case(name, 12000);
      for (double cell_m : {0.05, 3.0})
        for (int k : {1, 150, 3000}) expect_brute_force(c, lanes, cell_m, k == 1 ? 0.01 : 0.2, k);
    }
}

// oracle: brute force: nothing, one photon, fewer than are asked for: then the radius is the largest allowed
// tolerance: none
TEST(PhotonGather, FewPhotonsAgainstBruteForce) {
  for (std::size_t count : {0u, 1u, 2u, 149u, 600u})
    for (int lanes : {1, 4, 8})
      for (int k : {1, 150, 1000}) expect_brute_force(hard_case("cusp", count), lanes, 0.5, 0.3, k);
}

}  // namespace
}  // namespace greenray
