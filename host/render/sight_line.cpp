#include "render/sight_line.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/angle.hpp"

namespace greenray {
namespace {

constexpr int even_rays = 4096, halvings = 44;
constexpr double margin_rad = 0.012;  // more than any mirage near the horizon lifts or sinks
constexpr double base_above_hidden_m = 1e-3;

struct Sample {
  double elevation_rad;
  NearRay ray;
  bool arrives() const { return ray.outcome == f64::RAY_IN_FLIGHT || ray.outcome == f64::RAY_TRAPPED; }
};

class Sight {
 public:
  Sight(NearRays &rays, double distance_m, double target_height_m, const std::vector<double> &breaks_rad)
      : rays_(rays), distance_m_(distance_m) {
    const double lowest = std::min(geometric(0), horizon_rad()), highest = std::max(geometric(target_height_m), 0.0);
    const double low = std::max(-pi / 2, lowest - margin_rad), high = std::min(pi / 2, highest + margin_rad);
    std::vector<double> elevations;
    for (int i = 0; i <= even_rays; ++i) elevations.push_back(low + (high - low) * i / even_rays);
    for (const double b : breaks_rad)
      for (const double side : {-1e-10, 1e-10})
        if (b + side > low && b + side < high) elevations.push_back(b + side);
    std::sort(elevations.begin(), elevations.end());
    samples_ = trace(elevations);
    close_in_on_ends();
  }

  double geometric(double height_m) const { return geometric_altitude_rad(rays_, distance_m_, height_m); }

  /// Lowest height at which a ray arrives; minima between samples by thirds.
  double hidden_m() {
    double lowest = std::numeric_limits<double>::infinity();
    for (const Sample &s : samples_)
      if (s.arrives()) lowest = std::min(lowest, s.ray.height_m);
    for (std::size_t i = 1; i + 1 < samples_.size(); ++i) {
      const Sample &a = samples_[i - 1], &b = samples_[i], &c = samples_[i + 1];
      if (!a.arrives() || !b.arrives() || !c.arrives()) continue;
      if (b.ray.height_m <= a.ray.height_m && b.ray.height_m <= c.ray.height_m && b.ray.height_m < lowest + 1)
        lowest = std::min(lowest, minimum_m(a.elevation_rad, c.elevation_rad));
    }
    return std::isfinite(lowest) ? std::max(0.0, lowest) : lowest;
  }

  std::vector<SightImage> images(double height_m) {
    struct Bracket {
      double low, high;
      bool erect;
    };
    std::vector<Bracket> brackets;
    for (std::size_t i = 0; i + 1 < samples_.size(); ++i) {
      const Sample &a = samples_[i], &b = samples_[i + 1];
      if (!a.arrives() || !b.arrives() || (a.ray.height_m < height_m) == (b.ray.height_m < height_m)) continue;
      brackets.push_back({a.elevation_rad, b.elevation_rad, b.ray.height_m > a.ray.height_m});
    }
    for (int k = 0; k < halvings && !brackets.empty(); ++k) {
      std::vector<double> middles;
      for (const Bracket &b : brackets) middles.push_back(0.5 * (b.low + b.high));
      const std::vector<Sample> at = trace(middles);
      for (std::size_t i = 0; i < brackets.size(); ++i)
        ((at[i].ray.height_m < height_m) == brackets[i].erect ? brackets[i].low : brackets[i].high) = middles[i];
    }
    std::vector<SightImage> found;
    for (const Bracket &b : brackets) found.push_back(image(b.low, b.erect, height_m));
    return found;
  }

 private:
  std::vector<Sample> trace(const std::vector<double> &elevations) {
    const std::vector<NearRay> rays = rays_.trace(elevations, std::vector<double>{distance_m_});
    std::vector<Sample> samples;
    for (std::size_t i = 0; i < rays.size(); ++i) samples.push_back({elevations[i], rays[i]});
    return samples;
  }

  double horizon_rad() const {
    return rays_.flat() ? 0 : -std::acos(1 / (1 + rays_.height_m() / rays_.earth_radius_m()));
  }

  /// Where rays that arrive stand beside rays that do not, the edge by halving.
  void close_in_on_ends() {
    std::vector<std::pair<Sample, Sample>> edges;
    for (std::size_t i = 0; i + 1 < samples_.size(); ++i)
      if (samples_[i].arrives() != samples_[i + 1].arrives()) edges.emplace_back(samples_[i], samples_[i + 1]);
    for (int k = 0; k < halvings && !edges.empty(); ++k) {
      std::vector<double> middles;
      for (const auto &[a, b] : edges) middles.push_back(0.5 * (a.elevation_rad + b.elevation_rad));
      const std::vector<Sample> at = trace(middles);
      for (std::size_t i = 0; i < edges.size(); ++i)
        (at[i].arrives() == edges[i].first.arrives() ? edges[i].first : edges[i].second) = at[i];
    }
    for (const auto &[a, b] : edges) samples_.push_back(a), samples_.push_back(b);
    std::sort(samples_.begin(), samples_.end(),
              [](const Sample &a, const Sample &b) { return a.elevation_rad < b.elevation_rad; });
  }

  double minimum_m(double low, double high) {
    double lowest = std::numeric_limits<double>::infinity();
    for (int round = 0; round < 12; ++round) {
      std::vector<double> across;
      for (int k = 0; k <= 8; ++k) across.push_back(low + (high - low) * k / 8);
      const std::vector<Sample> at = trace(across);
      std::size_t best = 1;
      for (std::size_t k = 1; k < 8; ++k)
        if (at[k].arrives() && at[k].ray.height_m < at[best].ray.height_m) best = k;
      if (at[best].arrives()) lowest = std::min(lowest, at[best].ray.height_m);
      low = across[best - 1], high = across[best + 1];
    }
    return lowest;
  }

  SightImage image(double elevation_rad, bool erect, double height_m) {
    const Sample s = trace({elevation_rad}).front();
    const double refraction = elevation_rad - geometric(height_m), per_distance = rays_.earth_radius_m() / distance_m_;
    return {to_deg(elevation_rad), erect, to_arcsec(refraction), 2 * refraction * per_distance,
            s.ray.bending_rad * per_distance};
  }

  NearRays &rays_;
  double distance_m_;
  std::vector<Sample> samples_;
};

}  // namespace

// With n = n0 (R/r)^k, Bouguer's r^(1-k) cos e is constant along a ray and e grows as (1 - k) times the central angle.
double horizon_distance_m(double earth_radius_m, double height_m, double k) {
  return earth_radius_m / (1 - k) * std::acos(std::exp(-(1 - k) * std::log1p(height_m / earth_radius_m)));
}

double hidden_height_m(double earth_radius_m, double height_m, double distance_m, double k) {
  if (k >= 1) return 0;
  const double beyond_m = distance_m - horizon_distance_m(earth_radius_m, height_m, k);
  const double level_to = (1 - k) * beyond_m / earth_radius_m;
  if (level_to <= 0) return 0;
  if (level_to >= pi / 2) return std::numeric_limits<double>::infinity();
  return earth_radius_m * std::expm1(-std::log(std::cos(level_to)) / (1 - k));
}

double geometric_altitude_rad(const NearRays &rays, double distance_m, double height_m) {
  if (rays.flat()) return std::atan2(height_m - rays.height_m(), distance_m);
  const double angle = distance_m / rays.earth_radius_m(), half = std::sin(angle / 2);
  const double to = rays.earth_radius_m() + height_m;
  // (R + h) cos a - (R + h0), without the difference of large numbers
  return std::atan2(height_m - rays.height_m() - 2 * to * half * half, to * std::sin(angle));
}

SightLine sight_line(NearRays &rays, double distance_m, double target_height_m, const std::vector<double> &breaks_rad) {
  Sight sight(rays, distance_m, target_height_m, breaks_rad);
  SightLine line;
  line.distance_m = distance_m, line.target_height_m = target_height_m;
  line.geometric_altitude_deg = to_deg(sight.geometric(target_height_m));
  line.hidden_m = sight.hidden_m();
  const double radius = rays.earth_radius_m();
  line.hidden_straight_m = rays.flat() ? 0 : hidden_height_m(radius, rays.height_m(), distance_m, 0);
  line.hidden_k013_m = rays.flat() ? 0 : hidden_height_m(radius, rays.height_m(), distance_m, 0.13);
  if (target_height_m >= line.hidden_m) line.top = sight.images(target_height_m);
  if (std::isfinite(line.hidden_m) && line.hidden_m < target_height_m)
    line.base = sight.images(line.hidden_m + base_above_hidden_m);
  return line;
}

}  // namespace greenray
