#include "vision/glare.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

namespace greenray::vision {

namespace {

constexpr double deg = std::numbers::pi / 180;

/// amplitude / (1 + (theta/core)^2)^power
struct PowerTerm {
  double amplitude_per_sr, core_deg, power;
};

struct GlareTerms {
  std::vector<PowerTerm> powers;  // the innermost first
  double constant_per_sr, quadratic_per_sr_deg2;
};

GlareTerms terms_of(const Eye &eye) {
  const double age4 = std::pow(eye.age_years / 70, 4), p = eye.pigmentation;
  const double norm = 1 + p * (0.0417 + 0.055 * age4);
  const double core = (1 - 0.08 * age4) / norm, veil = (1 + 1.6 * age4) / norm;
  return {{{9.2e6 * core, 0.0046, 1.5},
           {1.5e5 * core, 0.045, 1.5},
           {400 * veil, 0.1, 1.0},
           {1300 * p * veil, 0.1, 1.5},
           {0.8 * p * veil, 0.1, 0.5}},
          2.5e-3 * p / norm,
          3e-8 * veil};
}

double value(const PowerTerm &term, double theta_deg) {
  const double ratio = theta_deg / term.core_deg;
  return term.amplitude_per_sr * std::pow(1 + ratio * ratio, -term.power);
}

/// Over the half sphere [sr]: log-spaced midpoints.
double half_sphere_integral(const std::function<double(double)> &per_sr) {
  constexpr int steps = 2000;  // a hundredth of e each: the error is its square over 24
  const double from = std::log(1e-7), step = (std::log(90.0) - from) / steps;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double theta_deg = std::exp(from + (i + 0.5) * step);
    sum += per_sr(theta_deg) * std::sin(theta_deg * deg) * theta_deg * deg * step;
  }
  return 2 * std::numbers::pi * sum;
}

/// sums[i] += height of the Gaussian of width unit 2^(i/2). Widths beyond 400 degrees are constants.
void add_gaussians(const PowerTerm &term, double unit_deg, std::map<int, double> &sums, double &constant) {
  const double log_step = std::numbers::ln2;  // of s, for widths sqrt(2) apart: s = (core/width)^2 / 2
  const auto height = [&](double s) {
    return term.amplitude_per_sr * log_step * std::pow(s, term.power) * std::exp(-s) / std::tgamma(term.power);
  };
  const auto width_deg = [unit_deg](int i) { return unit_deg * std::exp2(0.5 * i); };
  int i = static_cast<int>(std::floor(2 * std::log2(term.core_deg / 12 / unit_deg)));  // s = 72: exp(-72) is nothing
  for (; width_deg(i) < 400; ++i) {
    const double ratio = term.core_deg / width_deg(i);
    sums[i] += height(0.5 * ratio * ratio);
  }
  const double ratio = term.core_deg / width_deg(i);
  constant += height(0.5 * ratio * ratio) / (1 - std::exp2(-term.power));  // the rest is a geometric series
}

}  // namespace

double glare_spread_per_sr(double theta_deg, const Eye &eye) {
  const GlareTerms terms = terms_of(eye);
  double sum = terms.constant_per_sr + terms.quadratic_per_sr_deg2 * theta_deg * theta_deg;
  for (const PowerTerm &term : terms.powers) sum += value(term, theta_deg);
  return sum;
}

double GlareSum::per_sr(double theta_deg) const {
  double sum = constant_per_sr + quadratic_per_sr_deg2 * theta_deg * theta_deg;
  for (const GaussianSpread &g : gaussians) {
    const double ratio = theta_deg / g.sigma_deg;
    sum += g.per_sr * std::exp(-0.5 * ratio * ratio);
  }
  return sum;
}

GlareSum glare_as_gaussians(const Eye &eye, double sigma_unit_deg) {
  GlareTerms terms = terms_of(eye);
  const PowerTerm core = terms.powers.front();
  const double whole = half_sphere_integral([&](double theta) { return glare_spread_per_sr(theta, eye); });
  const double of_core = half_sphere_integral([&](double theta) { return value(core, theta); });
  terms.powers.front().amplitude_per_sr *= 1 - (whole - 1) / of_core;
  GlareSum sum{{}, terms.constant_per_sr, terms.quadratic_per_sr_deg2};
  std::map<int, double> heights;
  for (const PowerTerm &term : terms.powers) add_gaussians(term, sigma_unit_deg, heights, sum.constant_per_sr);
  for (const auto &[i, height] : heights) sum.gaussians.push_back({sigma_unit_deg * std::exp2(0.5 * i), height});
  return sum;
}

}  // namespace greenray::vision
