// Scenes of triangles and spheres for tests, and an independent brute-force search for what a ray meets, in double.
#pragma once
#include <cmath>
#include <random>
#include <vector>

#include "compute/surface_scene.hpp"
#include "scene/bvh.hpp"

namespace greenray {

inline Triple random_triple(std::mt19937 &engine, double low, double high) {
  std::uniform_real_distribution<double> uniform(low, high);
  const double x = uniform(engine), y = uniform(engine), z = uniform(engine);
  return {x, y, z};
}

inline Triple random_direction(std::mt19937 &engine) {
  std::normal_distribution<double> normal;
  const double x = normal(engine), y = normal(engine), z = normal(engine);
  return unit({x, y, z});
}

/// Loose triangles of all sizes in the cube -size..size, some spheres among them.
inline Surfaces soup(int triangles, int spheres, double size_m, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> log_size(std::log(0.01), std::log(0.5));
  Surfaces out;
  for (int i = 0; i < triangles; ++i) {
    const Triple at = random_triple(engine, -size_m, size_m);
    const double edge = size_m * std::exp(log_size(engine));
    out.triangles.push_back(
        {{at, at + edge * random_direction(engine), at + edge * random_direction(engine)}, {}, {}, 0, -1});
  }
  for (int i = 0; i < spheres; ++i)
    out.spheres.push_back({random_triple(engine, -size_m, size_m), 0.3 * size_m * std::exp(log_size(engine)), 0, -1});
  return out;
}

/// A closed ball of 20 * 4^splits triangles.
inline Surfaces ball(int splits, double radius_m, Triple centre = {0, 0, 0}) {
  const double g = (1 + std::sqrt(5)) / 2;
  const std::vector<Triple> corner{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  const int face[20][3] = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                           {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                           {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  std::vector<std::array<Triple, 3>> faces;
  for (const auto &f : face)
    faces.push_back({unit(corner[static_cast<std::size_t>(f[0])]), unit(corner[static_cast<std::size_t>(f[1])]),
                     unit(corner[static_cast<std::size_t>(f[2])])});
  for (int s = 0; s < splits; ++s) {
    std::vector<std::array<Triple, 3>> finer;
    for (const auto &[a, b, c] : faces) {
      const Triple ab = unit(a + b), bc = unit(b + c), ca = unit(c + a);
      for (const auto &f : {std::array<Triple, 3>{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        finer.push_back(f);
    }
    faces = std::move(finer);
  }
  Surfaces out;
  for (const auto &f : faces)
    out.triangles.push_back(
        {{centre + radius_m * f[0], centre + radius_m * f[1], centre + radius_m * f[2]}, {}, {}, 0, -1});
  return out;
}

struct Met {
  double sigma = 1e300;
  int primitive = -1;
};

/// What a straight segment meets for certain, and what it may meet when edges are moved by margin_m.
struct BruteForce {
  Met certain, possible;
};

/* Moller & Trumbore 1997 on every triangle and the quadratic of every sphere, in double.
   margin_m: distance from an edge (or of a sphere's limb, or from the segment's ends) within which a hit is possible
   but not certain */
inline BruteForce brute_force(const Surfaces &scene, const Triple &place, const Triple &direction, double end,
                              double margin_m) {
  BruteForce found;
  const double speed = length(direction), margin_sigma = margin_m / speed;
  const auto note = [&](Met &nearest, double sigma, std::size_t primitive) {
    if (sigma < nearest.sigma) nearest = {sigma, static_cast<int>(primitive)};
  };
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const Triangle &t = scene.triangles[i];
    const Triple e1 = t.corner[1] - t.corner[0], e2 = t.corner[2] - t.corner[0], p = cross(direction, e2);
    const double determinant = dot(e1, p);
    if (determinant == 0) continue;
    const Triple from = place - t.corner[0], q = cross(from, e1);
    const double u = dot(from, p) / determinant, v = dot(direction, q) / determinant, sigma = dot(e2, q) / determinant;
    const double twice_area = length(cross(e1, e2));
    // Distances from the three sides, inside positive.
    const double inside = std::min(
        {u * twice_area / length(e2), v * twice_area / length(e1), (1 - u - v) * twice_area / length(e2 - e1)});
    // A shallow angle magnifies the rounding of the plane.
    const double steepness = std::abs(determinant) / (twice_area * speed), reach = margin_m / steepness;
    if (inside > -reach && sigma > -margin_sigma / steepness && sigma < end + margin_sigma / steepness)
      note(found.possible, sigma, i);
    if (inside > reach && sigma > margin_sigma / steepness && sigma < end - margin_sigma / steepness)
      note(found.certain, sigma, i);
  }
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    const Sphere &s = scene.spheres[i];
    const Triple from = place - s.centre;
    const double a = dot(direction, direction), b = dot(from, direction), c = dot(from, from) - s.radius_m * s.radius_m;
    const double closest = length(from - (b / a) * direction);
    for (const double wider : {margin_m, -margin_m}) {
      const double r = s.radius_m + wider;
      if (closest >= r) continue;
      const double half = std::sqrt(std::max(s.radius_m * s.radius_m - closest * closest, 0.0) / a), middle = -b / a;
      const double sigma = c < 0 ? middle + half : middle - half;
      const bool is_possible = sigma > -margin_sigma && sigma < end + margin_sigma;
      const bool is_certain =
          sigma > margin_sigma && sigma < end - margin_sigma && std::abs(c) > 2 * s.radius_m * margin_m;
      if (wider > 0 ? is_possible : is_certain)
        note(wider > 0 ? found.possible : found.certain, sigma, scene.triangles.size() + i);
    }
  }
  return found;
}

/// A scene on the host twin, one float at a time; owns the arrays that the kernels' structs point into.
struct TwinScene {
  SurfaceTree tree;
  std::vector<surface32::AirLayer> layers;
  std::vector<surface32::AirCell> cells;
  surface32::AirShape shape;

  TwinScene(const Surfaces &surfaces, const AirTable &air, double longest_sag_m = 0.2)
      : tree(build_surface_tree(surfaces, 1)),
        layers(air.narrowed_layers()),
        cells(air.narrowed()),
        shape{static_cast<int>(air.layers.size()), static_cast<int>(air.cells),
              static_cast<float>(air.extinction_per_m), static_cast<float>(longest_sag_m)} {}
  surface32::Geometry geometry() const {
    return {tree.boxes.data(),     tree.children.data(), tree.blocks.data(), tree.block_ids.data(),
            tree.triangles.data(), tree.spheres.data(),  tree.bounds};
  }
  surface32::Air air() const { return {layers.data(), cells.data(), shape}; }
  surface32::PathEnd trace(const surface32::PathStart &start) const {
    surface32::PathEnd end{};
    const surface32::Geometry g = geometry();
    const surface32::Air a = air();
    surface32::trace_path(&g, &a, start, &end);
    return end;
  }
};

inline surface32::PathStart path_start(const Triple &place, const Triple &momentum, int row = 0) {
  surface32::PathStart s{};
  for (std::size_t a = 0; a < 3; ++a) {
    s.place[a] = static_cast<float>(place[a]);
    s.momentum[a] = static_cast<float>(momentum[a]);
  }
  s.row = row;
  return s;
}

inline Triple triple_of(const float (&v)[3]) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

}  // namespace greenray
