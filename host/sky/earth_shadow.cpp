#include "sky/earth_shadow.hpp"

#include <algorithm>
#include <cmath>

#include "support/angle.hpp"
#include "support/fast_math.hpp"

namespace greenray {
namespace {

/// Density of the Sun's light over its projected disk, integral 1 [1/m^2].
double disk_density(double distance_m, double disk_m) {
  const double mu2 = 1 - std::pow(distance_m / disk_m, 2);
  if (mu2 <= 0) return 0;
  return (0.4 + 0.6 * std::sqrt(mu2)) / (0.8 * pi * disk_m * disk_m);  // mean of 0.4 + 0.6 mu over the disk: 0.8
}

/// Mean over a circle about the axis, of the density seen from a point: both given by their distances from the axis.
double mean_on_circle(double circle_m, double point_m, double disk_m) {
  constexpr int steps = 64;
  if (std::abs(circle_m - point_m) >= disk_m) return 0;
  double widest = pi;  // half of the arc within the disk
  if (circle_m > 0 && point_m > 0) {
    const double cosine = (circle_m * circle_m + point_m * point_m - disk_m * disk_m) / (2 * circle_m * point_m);
    widest = std::acos(std::clamp(cosine, -1.0, 1.0));
  }
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double half = std::sin(0.5 * widest * (i + 0.5) / steps), apart = circle_m - point_m;
    sum += disk_density(std::sqrt(apart * apart + 4 * circle_m * point_m * half * half), disk_m);
  }
  return sum / steps * widest / pi;
}

}  // namespace

EarthShadow::EarthShadow(const AirShells &shells, const SkyOptics &optics, double sun_radius_rad, double distance_m,
                         double sun_distance_m)
    : padded_(optics.padded()) {
  const double earth_m = shells.radius_m(), disk_m = distance_m * std::tan(sun_radius_rad);
  const double spread = 1 + distance_m / sun_distance_m;  // of the shadow's cone, from a point of the Sun
  const double widest_m = spread * earth_m + 1.05 * disk_m;
  share_.assign((static_cast<std::size_t>(widest_m / step_m_) + 2) * padded_, 0.0f);
  for (std::size_t k = 0; k < shells.levels(); ++k) {
    const AirShells::Exit out = shells.exit(k, 0);
    if (out.end == PathEnd::space)
      grazes_.push_back({shells.height_m(k), shells.impact_m(k), 2 * out.bending_rad, out.column * 2});
  }
  const auto lay = [&](double ring_m, double wide_m, double bending_rad, const Columns &column) {
    std::vector<float> flux(padded_);
    optical_depths(optics, column, flux.data());
    const double area = 2 * pi * ring_m * wide_m * spread * spread;  // that it would light without air
    for (float &f : flux) f = static_cast<float>(area) * fast_exp_of_negative(-f);
    add_ring(std::abs(ring_m * spread - distance_m * std::tan(bending_rad)), flux, disk_m);
  };
  for (std::size_t k = 0; k + 1 < grazes_.size(); ++k) {
    constexpr int parts = 6;  // of a shell: rings far narrower than the disk
    const Graze &a = grazes_[k], &b = grazes_[k + 1];
    for (int i = 0; i < parts; ++i) {
      const double t = (i + 0.5) / parts;
      const Columns column = a.column + (b.column - a.column) * t;
      lay(a.impact_m + t * (b.impact_m - a.impact_m), (b.impact_m - a.impact_m) / parts,
          a.bending_rad + t * (b.bending_rad - a.bending_rad), column);
    }
  }
  constexpr double open_ring_m = 20e3;
  for (double ring_m = grazes_.back().impact_m; ring_m < (widest_m + 2 * disk_m) / spread; ring_m += open_ring_m)
    lay(ring_m + 0.5 * open_ring_m, open_ring_m, 0, {});
}

/// Spreads a ring's light over the rows.
void EarthShadow::add_ring(double radius_m, const std::vector<float> &flux, double disk_m) {
  const auto first = static_cast<std::size_t>(std::max(0.0, (radius_m - disk_m) / step_m_));
  for (std::size_t i = first; i < rows() && static_cast<double>(i) * step_m_ < radius_m + disk_m; ++i) {
    const auto density = static_cast<float>(mean_on_circle(radius_m, static_cast<double>(i) * step_m_, disk_m));
    float *row = &share_[i * padded_];
    for (std::size_t w = 0; w < padded_; ++w) row[w] += density * flux[w];
  }
}

void EarthShadow::share(double from_axis_m, float *share) const {
  const double at = from_axis_m / step_m_;
  const auto i = static_cast<std::size_t>(at);
  if (i + 1 >= rows()) return std::fill(share, share + padded_, 1.0f);
  const auto t = static_cast<float>(at - static_cast<double>(i));
  for (std::size_t w = 0; w < padded_; ++w) share[w] = row(i)[w] + t * (row(i + 1)[w] - row(i)[w]);
}

}  // namespace greenray
