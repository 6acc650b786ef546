#include "bench/photon_case.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "bench/race.hpp"
#include "twin/photon_twin.hpp"

namespace greenray::bench {
namespace {

constexpr std::array<double, 3> size_m{6, 4, 3};
constexpr double patch_sigma_m = 0.4;  // 2 pi sigma^2 = 1 m^2

unsigned inward(int axis, bool far_wall) {
  const float side = far_wall ? -1.0f : 1.0f;
  return photon_twin::pack_normal(axis == 0 ? side : 0, axis == 1 ? side : 0, axis == 2 ? side : 0);
}

GatherPoint on_wall(std::mt19937 &engine, double area_m2) {
  std::uniform_real_distribution<double> unit(0, 1);
  double pick = unit(engine) * area_m2 / 2;
  int axis = 0;
  const auto face = [](int k) { return size_m[(k + 1) % 3] * size_m[(k + 2) % 3]; };
  while (axis < 2 && pick > face(axis)) pick -= face(axis++);
  const bool far_wall = unit(engine) < 0.5;
  GatherPoint at{};
  for (int k = 0; k < 3; ++k)
    at.place_m[k] =
        static_cast<float>(size_m[static_cast<std::size_t>(k)] * (k == axis ? (far_wall ? 1 : 0) : unit(engine)));
  at.normal = inward(axis, far_wall);
  return at;
}

/// On the wall y = 4 m, where the camera looks.
GatherPoint in_patch(std::mt19937 &engine) {
  std::normal_distribution<double> off(0, patch_sigma_m);
  const double x = std::clamp(2 + off(engine), 0.0, size_m[0]), z = std::clamp(1.5 + off(engine), 0.0, size_m[2]);
  return {{static_cast<float>(x), static_cast<float>(size_m[1]), static_cast<float>(z)}, inward(1, true)};
}

/// A cardioid's arc on the wall y = 4 m, as light in a cup draws it, bright at its cusp.
GatherPoint on_caustic(std::mt19937 &engine) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> off(0, 0.002);
  const double angle = (2 * unit(engine) - 1) * std::acos(-1.0), size = 0.5 * (1 - std::cos(angle));
  const double x = 3 + size * std::cos(angle) + off(engine), z = 1.5 + size * std::sin(angle) + off(engine);
  return {{static_cast<float>(x), static_cast<float>(size_m[1]), static_cast<float>(z)}, inward(1, true)};
}

GatherPoint in_air(std::mt19937 &engine) {
  std::uniform_real_distribution<double> unit(0, 1);
  GatherPoint at{};
  for (std::size_t k = 0; k < 3; ++k) at.place_m[k] = static_cast<float>(size_m[k] * unit(engine));
  at.normal = inward(1, true);
  return at;
}

GatherPoint landing(Light light, std::mt19937 &engine, double area_m2) {
  std::uniform_real_distribution<float> unit(0, 1);
  if (light == Light::volume) return in_air(engine);
  if (light == Light::lit && unit(engine) < 0.3f) return in_patch(engine);
  if (light == Light::caustic && unit(engine) < 0.6f) return on_caustic(engine);
  return on_wall(engine, area_m2);
}

/// Where a ray from inside leaves the box.
GatherPoint seen(const std::array<double, 3> &eye, const std::array<double, 3> &direction) {
  double nearest = 1e30;
  int axis = 0;
  for (int k = 0; k < 3; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const double t = ((direction[at] > 0 ? size_m[at] : 0) - eye[at]) / direction[at];
    if (direction[at] != 0 && t < nearest) nearest = t, axis = k;
  }
  GatherPoint point{};
  for (int k = 0; k < 3; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const double wall = direction[at] > 0 ? size_m[at] : 0;
    point.place_m[k] = static_cast<float>(k == axis ? wall : eye[at] + nearest * direction[at]);
  }
  point.normal = inward(axis, direction[static_cast<std::size_t>(axis)] > 0);
  return point;
}

float distance2(const Photon &p, const GatherPoint &q) {
  const float dx = p.place_m[0] - q.place_m[0], dy = p.place_m[1] - q.place_m[1], dz = p.place_m[2] - q.place_m[2];
  return (dx * dx + dy * dy) + dz * dz;
}

}  // namespace

PhotonCase photon_case(Light light, std::size_t photons, int width, int height) {
  PhotonCase c;
  c.name = std::array{"even-room", "lit-room", "caustic", "volume"}[static_cast<std::size_t>(light)];
  double area_m2 = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    c.room.high_m[k] = size_m[k];
    area_m2 += 2 * size_m[(k + 1) % 3] * size_m[(k + 2) % 3];
  }
  const double share = 150 / static_cast<double>(photons), pi = std::acos(-1.0);
  c.radius_m = light == Light::volume ? std::cbrt(share * size_m[0] * size_m[1] * size_m[2] * 3 / (4 * pi))
                                      : std::sqrt(share * area_m2 / pi);
  std::mt19937 engine(20040601);
  std::uniform_real_distribution<float> unit(0, 1);
  for (std::size_t i = 0; i < photons; ++i) {
    const GatherPoint at = landing(light, engine, area_m2);
    Photon p{};
    std::copy(at.place_m, at.place_m + 3, p.place_m);
    p.normal = at.normal;
    p.id = static_cast<unsigned>(i);
    p.tags = PHOTON_TAGS(0, PHOTON_DIRECT);
    c.photons.push_back(p);
    c.power_W.push_back(0.1f + 0.9f * unit(engine));
  }
  const std::array<double, 3> eye{3.1, 0.4, 1.6};
  const double view = light == Light::caustic ? 0.3 : 1.5;  // of the caustic, its cusp
  for (int tile_y = 0; tile_y < height; tile_y += 8)
    for (int tile_x = 0; tile_x < width; tile_x += 8)
      for (int y = tile_y; y < std::min(tile_y + 8, height); ++y)
        for (int x = tile_x; x < std::min(tile_x + 8, width); ++x)
          c.points.push_back(
              seen(eye, {(x + 0.5 - 0.5 * width) * view / width, 1, (0.5 * height - y - 0.5) * view / width}));
  if (light != Light::volume) return c;
  for (std::size_t i = 0; i < c.points.size(); ++i)  // a quarter to three quarters of the way
    for (std::size_t k = 0; k < 3; ++k) {
      const float way = 0.25f + 0.5f * static_cast<float>(i / 64 % 97) / 96;
      const float from = static_cast<float>(eye[k]);
      c.points[i].place_m[k] = from + way * (c.points[i].place_m[k] - from);
    }
  return c;
}

BruteForce brute_force(const PhotonCase &c, const std::vector<std::size_t> &points, float radius_m, bool one_wall,
                       unsigned threads) {
  BruteForce out{std::vector<double>(points.size()), std::vector<int>(points.size())};
  const float radius2 = radius_m * radius_m;
  on_threads(points.size(), 4, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t q = first; q < last; ++q)
      for (std::size_t i = 0; i < c.photons.size(); ++i) {
        const float d2 = distance2(c.photons[i], c.points[points[q]]);
        if (!(d2 < radius2) || (one_wall && c.photons[i].normal != c.points[points[q]].normal)) continue;
        ++out.counts[q];
        const double r2 = static_cast<double>(radius2);
        out.irradiance[q] +=
            static_cast<double>(c.power_W[i]) * (1 - static_cast<double>(d2) / r2) * 2 / (std::acos(-1.0) * r2);
      }
  });
  return out;
}

std::vector<float> brute_nearest(const PhotonCase &c, const std::vector<std::size_t> &points, int k, unsigned threads) {
  std::vector<float> radius2(points.size());
  on_threads(points.size(), 4, threads, [&](std::size_t first, std::size_t last) {
    std::vector<float> all(c.photons.size());
    for (std::size_t q = first; q < last; ++q) {
      for (std::size_t i = 0; i < all.size(); ++i) all[i] = distance2(c.photons[i], c.points[points[q]]);
      std::nth_element(all.begin(), all.begin() + (k - 1), all.end());
      radius2[q] = all[static_cast<std::size_t>(k) - 1];
    }
  });
  return radius2;
}

}  // namespace greenray::bench
