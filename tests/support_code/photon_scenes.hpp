// Photons on the walls of made-up rooms, for tests of the map.
#pragma once
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "compute/photon.hpp"
#include "twin/photon_twin.hpp"

namespace greenray {

struct Photons {
  std::vector<Photon> records;
  std::vector<float> power_W;  // [records][waves]
  int waves = 1;
};

/// A place on the walls of a room of 4 x 3 x 5 m that has its corner at (-1, 2, 10), with the wall's inward normal.
struct WallPlace {
  float place_m[3];
  unsigned normal;
};
inline WallPlace wall_place(std::mt19937 &engine) {
  std::uniform_real_distribution<double> unit(0, 1);
  const double size[3] = {4, 3, 5}, corner[3] = {-1, 2, 10};
  const double area[3] = {size[1] * size[2], size[0] * size[2], size[0] * size[1]};
  double pick = unit(engine) * (area[0] + area[1] + area[2]);
  int axis = 0;
  while (axis < 2 && pick > area[axis]) pick -= area[axis++];
  const bool far_wall = unit(engine) < 0.5;
  WallPlace at{};
  for (int k = 0; k < 3; ++k)
    at.place_m[k] = static_cast<float>(corner[k] + size[k] * (k == axis ? (far_wall ? 1 : 0) : unit(engine)));
  const float side = far_wall ? -1.0f : 1.0f;
  at.normal = photon_twin::pack_normal(axis == 0 ? side : 0, axis == 1 ? side : 0, axis == 2 ? side : 0);
  return at;
}

/// `count` photons in the order of their emission, some emissions landing several times; powers differ.
inline Photons photons_in_room(std::size_t count, int waves, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<float> unit(0.1f, 1.0f);
  Photons photons;
  photons.waves = waves;
  unsigned id = 0, bounce = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const WallPlace at = wall_place(engine);
    Photon p{};
    std::copy(at.place_m, at.place_m + 3, p.place_m);
    p.normal = at.normal;
    p.direction = 0x80008000u;
    p.id = id;
    p.tags = PHOTON_TAGS(bounce, bounce ? PHOTON_INDIRECT : PHOTON_DIRECT);
    photons.records.push_back(p);
    for (int w = 0; w < waves; ++w) photons.power_W.push_back(unit(engine));
    if (unit(engine) < 0.5f) ++bounce;
    else ++id, bounce = 0;
  }
  return photons;
}

inline std::vector<GatherPoint> points_in_room(std::size_t count, unsigned seed) {
  std::mt19937 engine(seed);
  std::vector<GatherPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const WallPlace at = wall_place(engine);
    points.push_back({{at.place_m[0], at.place_m[1], at.place_m[2]}, at.normal});
  }
  return points;
}

inline Photons shuffled(const Photons &photons, unsigned seed) {
  std::vector<std::size_t> order(photons.records.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  Photons mixed;
  mixed.waves = photons.waves;
  const auto waves = static_cast<std::size_t>(photons.waves);
  for (std::size_t i : order) {
    mixed.records.push_back(photons.records[i]);
    for (std::size_t w = 0; w < waves; ++w) mixed.power_W.push_back(photons.power_W[i * waves + w]);
  }
  return mixed;
}

}  // namespace greenray
