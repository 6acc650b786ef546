// Light scattered inside the eye: how a point of light spreads over the retina.
#pragma once
#include <vector>

namespace greenray::vision {

struct Eye {
  double age_years = 28.58;
  double pigmentation = 0.5;  // 0 very dark, 0.5 brown, 1 green-blue, 1.2 light blue
};

/* Share of the light of a point that reaches the retina theta_deg away from its image [sr^-1], at 0 to 100 degrees.
   source: CIE 135/1-1999, total glare function after Vos & van den Berg */
double glare_spread_per_sr(double theta_deg, const Eye &eye);

/// per_sr exp(-theta^2 / (2 sigma^2))
struct GaussianSpread {
  double sigma_deg;
  double per_sr;
};

/* The same function as a sum of Gaussians, whose widths grow by sqrt(2) from term to term, plus
   constant_per_sr + quadratic_per_sr_deg2 theta^2. The sum agrees with glare_spread_per_sr to 1e-4 of it, except that
   the innermost core is lowered by the 0.5 to 2 % by which the published function, integrated over the half sphere,
   exceeds 1: light is neither made nor lost.
   method: (1 + x)^-v = 1/Gamma(v) int s^(v-1) exp(-s (1 + x)) ds, by the trapezoidal rule in log s
   sigma_unit_deg: the widths are sigma_unit_deg x 2^(i/2) */
struct GlareSum {
  std::vector<GaussianSpread> gaussians;  // widths ascending
  double constant_per_sr = 0, quadratic_per_sr_deg2 = 0;
  double per_sr(double theta_deg) const;
};
GlareSum glare_as_gaussians(const Eye &eye, double sigma_unit_deg);

}  // namespace greenray::vision
