// The cubic through the four Gauss-Legendre places of 0..1: its integral is that of any polynomial up to degree 7, so
// that what a ray gathers on its way through a cell is right to far higher order than the cubic itself.
#pragma once
#include <array>
#include <cstddef>

namespace greenray {

inline constexpr std::array<double, 4> gauss_place{0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                                   0.93056815579702629};

using Cubic = std::array<double, 4>;  // coefficients, constant first

/// Coefficients of the cubic through (gauss_place[i], y[i]): Newton's divided differences, then expanded.
inline Cubic cubic_through(const std::array<double, 4> &y) {
  std::array<double, 4> d = y;
  for (std::size_t level = 1; level < 4; ++level)
    for (std::size_t i = 3; i >= level; --i) d[i] = (d[i] - d[i - 1]) / (gauss_place[i] - gauss_place[i - level]);
  Cubic c{d[3], 0, 0, 0};
  for (int k = 2; k >= 0; --k) {  // c(t) = c(t)(t - node_k) + d_k
    const auto n = static_cast<std::size_t>(k);
    for (std::size_t i = 3; i >= 1; --i) c[i] = c[i - 1] - gauss_place[n] * c[i];
    c[0] = d[n] - gauss_place[n] * c[0];
  }
  return c;
}

inline double evaluate(const Cubic &c, double t) { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); }

}  // namespace greenray
