// Gauss-Hermite quadrature: means over a Gaussian.
#pragma once
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace greenray {

/// Mean of f over a Gaussian of standard deviation 1: sum of weight[k] f(node[k]), exact for polynomials of degree
/// 2 n - 1. Nodes by Newton's method on the normalised Hermite functions, from the bottom up: each lies between the
/// last one and the ends of the zero-free gap that the largest distance between neighbours allows.
struct GaussHermite {
  std::vector<double> node, weight;

  explicit GaussHermite(int n) {
    double at = -std::sqrt(4.0 * n + 2);  // below the least zero, of the polynomial in x/sqrt(2)
    const double step = 0.5 * 3.14159265358979 / std::sqrt(4.0 * n + 2);  // under half the least distance of zeros
    double before = value(n, at).first;
    while (static_cast<int>(node.size()) < n) {
      const double next = at + step, after = value(n, next).first;
      if ((before < 0) != (after < 0)) add(n, at, next);
      at = next, before = after;
    }
  }

 private:
  /// Orthonormal (weight of a normal distribution) polynomials of degree n and n - 1 at x.
  static std::pair<double, double> value(int n, double x) {
    double low = 0, here = 1;
    for (int k = 0; k < n; ++k) {
      const double next = (x * here - std::sqrt(static_cast<double>(k)) * low) / std::sqrt(k + 1.0);
      low = here, here = next;
    }
    return {here, low};
  }

  void add(int n, double low, double high) {
    const bool rises = value(n, low).first < 0;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      ((value(n, middle).first < 0) == rises ? low : high) = middle;
    }
    const double x = 0.5 * (low + high), below = value(n, x).second;
    node.push_back(x);
    weight.push_back(1 / (n * below * below));
  }
};

}  // namespace greenray
