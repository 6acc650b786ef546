// The scene's surfaces in world coordinates, in double, as they come from a scene file; and the tree for rays.
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "support/error.hpp"

namespace greenray {

using Triple = std::array<double, 3>;

inline Triple operator+(const Triple &a, const Triple &b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Triple operator-(const Triple &a, const Triple &b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Triple operator*(double s, const Triple &a) { return {s * a[0], s * a[1], s * a[2]}; }
double dot(const Triple &a, const Triple &b);
Triple cross(const Triple &a, const Triple &b);
double length(const Triple &a);
Triple unit(const Triple &a);  // the zero vector stays zero

/// World frame [m]; the outside is where the corners run anticlockwise.
struct Triangle {
  std::array<Triple, 3> corner{};
  std::array<Triple, 3> corner_normal{};  // unit; all zero: flat
  std::array<std::array<double, 2>, 3> texture{};
  int material = 0;
  int light = -1;  // area light it is part of

  Triple area_vector_m2() const { return 0.5 * cross(corner[1] - corner[0], corner[2] - corner[0]); }
};

struct Sphere {
  Triple centre{};
  double radius_m = 1;
  int material = 0;
  int light = -1;
};

/// Primitives are numbered: triangles first, then spheres.
struct Surfaces {
  std::vector<Triangle> triangles;
  std::vector<Sphere> spheres;
  bool empty() const { return triangles.empty() && spheres.empty(); }
};

}  // namespace greenray
