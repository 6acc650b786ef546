// The closed form of one layer (kernels/ray/closed_form.h) against plain quadrature.
#include <gtest/gtest.h>

#include <cmath>

#include "twin/twin.hpp"

namespace greenray {
namespace {

/// A layer: sines squared at its edges and the two terms off the line.
struct OneLayer {
  double near2, far2, c, d;
  double sine2(double t) const { return near2 + (far2 - near2) * t - c * t * (1 - t) + d * t * (1 - t) * (t - 0.5); }
};

/// Integral of Legendre's polynomial of order q over t in 0..end, divided by the sine: midpoint rule in u, t = end (1 -
/// u^2), which takes the root's singularity at the far end away; the near end may be level too, so the other half is
/// mirrored.
double by_quadrature(const OneLayer &layer, double end, int q) {
  constexpr int n = 200000;
  const auto legendre = [q](double t) { return q == 0 ? 1 : q == 1 ? t - 0.5 : 6 * t * t - 6 * t + 1; };
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double u = (i + 0.5) / n;
    const double far = end * (1 - 0.5 * u * u), near = end * 0.5 * u * u;
    sum += (legendre(far) / std::sqrt(layer.sine2(far)) + legendre(near) / std::sqrt(layer.sine2(near))) * end * u / n;
  }
  return sum;
}

double factor(const f64::LayerFactors &f, int q) { return q == 0 ? f.mean : q == 1 ? f.tilt : f.bow; }

TEST(ClosedLayer, IsExactOnAStraightLine) {
  // oracle: quadrature of w(t)/sqrt(line(t))
  // tolerance: 1e-8 of the largest, the midpoint rule's error
  for (const OneLayer layer :
       {OneLayer{1, 1, 0, 0}, OneLayer{1e-6, 3e-6, 0, 0}, OneLayer{0, 2e-7, 0, 0}, OneLayer{0.3, 0.1, 0, 0}}) {
    const f64::LayerFactors f = f64::layer_factors(std::sqrt(layer.near2), std::sqrt(layer.far2), 0, 0);
    for (int q = 0; q < 3; ++q)
      EXPECT_NEAR(factor(f, q), by_quadrature(layer, 1, q), 1e-8 * f.mean) << layer.near2 << " " << q;
  }
}

TEST(ClosedLayer, NeglectsOnlyThirdOrderOfTheBulge) {
  // oracle: quadrature; halving c and d together must divide the error of the mean by 4 at least (d enters to first
  // order, so
  //         its square is the first term left out; alone, c leaves out its cube: by 8)
  // tolerance: factor 3.5 and 7, since the next terms are not yet negligible
  const auto error = [](double c, double d) {
    const OneLayer layer{1e-6, 4e-6, c, d};
    return std::abs(f64::layer_factors(1e-3, 2e-3, c, d).mean - by_quadrature(layer, 1, 0));
  };
  EXPECT_GT(error(4e-6, 0) / error(2e-6, 0), 7);
  EXPECT_GT(error(1e-6, 4e-6) / error(0.5e-6, 2e-6), 3.5);
  EXPECT_LT(error(2e-7, 2e-7), 1e-4 * f64::layer_factors(1e-3, 2e-3, 0, 0).mean);
}

TEST(ClosedLayer, TurningRaysEndAtTheRoot) {
  // oracle: the root by bisection, the integrals by quadrature up to it
  // tolerance: 1e-12 for the root; 2e-4 of the mean for the integrals (the bow takes no bulge into account: 3e-3 for
  // it)
  for (const OneLayer layer :
       {OneLayer{1e-6, -1e-6, 0, 0}, OneLayer{1e-6, -3e-6, 4e-8, 2e-8}, OneLayer{2e-6, -1e-7, -3e-8, 1e-8}}) {
    double low = 0, high = 1;
    for (int i = 0; i < 100; ++i) (layer.sine2(0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
    const f64::LayerSine sine = f64::layer_sine(layer.near2, layer.far2, layer.c, layer.d);
    const double turn = f64::turning_place(&sine);
    const f64::LayerFactors f = f64::part_factors(&sine, turn, 0);
    EXPECT_NEAR(turn, low, 1e-6);
    for (int q = 0; q < 3; ++q)
      EXPECT_NEAR(factor(f, q), by_quadrature(layer, low, q), (q == 2 ? 3e-3 : 2e-4) * f.mean) << layer.c << " " << q;
  }
}

TEST(ClosedLayer, PartsOfALayerAreAsGoodAsTheWhole) {
  // oracle: quadrature of w(t)/sqrt(sine2(t)) over 0..f
  // tolerance: 2e-4 of the mean, the bulge's third order; the bow takes no bulge into account: 3e-3
  for (const OneLayer layer :
       {OneLayer{1e-6, 3e-6, 4e-8, 2e-8}, OneLayer{0, 2e-6, 8e-9, 0}, OneLayer{3e-6, 1e-6, 0, 0}})
    for (double f : {0.1, 0.5, 0.9, 1.0}) {
      const f64::LayerSine sine = f64::layer_sine(layer.near2, layer.far2, layer.c, layer.d);
      const f64::LayerFactors part = f64::part_factors(&sine, f, f64::sine2_at(&sine, f));
      for (int q = 0; q < 3; ++q)
        EXPECT_NEAR(factor(part, q), by_quadrature(layer, f, q), (q == 2 ? 3e-3 : 2e-4) * part.mean) << f << " " << q;
    }
}

}  // namespace
}  // namespace greenray
