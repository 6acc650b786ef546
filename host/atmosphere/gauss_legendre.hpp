// Gauss-Legendre quadrature on a panel, 12 points: exact to degree 23.
#pragma once
#include <array>
#include <cstddef>

namespace greenray {

inline constexpr std::array<double, 6> legendre_node{0.1252334085114689, 0.3678314989981802, 0.5873179542866175,
                                                     0.7699026741943047, 0.9041172563704749, 0.9815606342467192};
inline constexpr std::array<double, 6> legendre_weight{0.2491470458134028, 0.2334925365383548, 0.2031674267230659,
                                                       0.1600783285433462, 0.1069393259953184, 0.0471753363865118};

/// Integral of f over [a, b].
template <class F>
double integrate_panel(double a, double b, F &&f) {
  const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
  double sum = 0;
  for (std::size_t i = 0; i < legendre_node.size(); ++i)
    sum += legendre_weight[i] * (f(middle - half * legendre_node[i]) + f(middle + half * legendre_node[i]));
  return half * sum;
}

}  // namespace greenray
