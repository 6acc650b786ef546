#include "scene/surfaces.hpp"

#include <cmath>

namespace greenray {

double dot(const Triple &a, const Triple &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Triple cross(const Triple &a, const Triple &b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double length(const Triple &a) { return std::hypot(a[0], a[1], a[2]); }

Triple unit(const Triple &a) {
  const double l = length(a);
  return l > 0 ? (1 / l) * a : a;
}

}  // namespace greenray
