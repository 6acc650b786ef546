#include "sky/sunlight.hpp"

#include <algorithm>
#include <cmath>

#include "support/angle.hpp"
#include "support/fast_math.hpp"
#include "support/parallel.hpp"

namespace greenray {
namespace {

/// Share of the disk's light below a chord, x = height above its centre over the radius: I = 0.4 + 0.6 mu.
double disk_below(double x) {
  x = std::clamp(x, -1.0, 1.0);
  const auto integral = [](double t) {
    return 0.4 * (t * std::sqrt(std::max(0.0, 1 - t * t)) + std::asin(t)) + 0.6 * (pi / 2) * (t - t * t * t / 3);
  };
  return (integral(x) - integral(-1)) / (integral(1) - integral(-1));
}

/// Offsets from the horizon, in steps that grow: `first` up to `fine`, then by `growth` of themselves, to `last`.
std::vector<double> growing(double from, double first, double fine, double growth, double last) {
  std::vector<double> x;
  for (double at = from; at < last; at += at < fine ? first : growth * at) x.push_back(at);
  x.push_back(last);
  return x;
}

/// Levels at which sunlight is tabulated.
std::vector<std::size_t> chosen_levels(const AirShells &shells) {
  std::vector<std::size_t> chosen{0};
  double next_m = 0;
  for (std::size_t k = 0; k + 1 < shells.levels(); ++k) {
    const double h = shells.height_m(k);
    if (k > 0 && h < next_m) continue;
    if (k > 0) chosen.push_back(k);
    next_m = h + std::clamp(0.15 * h, 50.0, h > 40000 ? 5000.0 : 2500.0);
  }
  chosen.push_back(shells.levels() - 1);
  return chosen;
}

/// One ray from the Sun's side, seen from below: apparent and true altitude, and what it passed.
struct Seen {
  double apparent_rad, true_rad;
  Columns column;
  bool clear;
};

std::vector<Seen> fan(const AirShells &shells, std::size_t level) {
  constexpr double above_it = 1e-9, deg = pi / 180;
  const double lowest = shells.lowest_clear_rad(level) + above_it;
  std::vector<Seen> fan;
  for (double offset : growing(0, 0.02 * deg, 1.2 * deg, 0.04, pi / 2 - lowest)) {
    const double e = std::min(lowest + offset, pi / 2);
    const AirShells::Exit exit = shells.exit(level, e);
    fan.push_back({e, e - exit.bending_rad, exit.column, exit.end == PathEnd::space});
  }
  return fan;
}

Columns between(const Columns &a, const Columns &b, double t) { return a + (b - a) * t; }

}  // namespace

Sunlight::Sunlight(const AirShells &shells, const SkyOptics &optics, double sun_radius_rad)
    : padded_(optics.padded()), radius_rad_(sun_radius_rad) {
  constexpr double deg = pi / 180;
  above_horizon_rad_ = Axis(growing(-1.05 * radius_rad_, 0.03 * deg, 1.5 * deg, 0.05, pi));
  const std::vector<std::size_t> levels = chosen_levels(shells);
  std::vector<double> heights;
  for (std::size_t level : levels) heights.push_back(shells.height_m(level));
  height_m_ = Axis(heights);
  horizon_rad_.resize(levels.size());
  share_.resize(levels.size() * above_horizon_rad_.size() * padded_);
  lift_rad_.resize(levels.size() * above_horizon_rad_.size());
  for_pieces(levels.size(), 1, host_threads(), [&](std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) fill_level(shells, optics, row, levels[row]);
  });
  for (double horizon : horizon_rad_) dip2_.push_back(std::pow(horizon_rad_.front() - horizon, 2));
}

/// The integral over apparent altitudes, ray by ray of a fan: between two of them the true altitude is linear, and so
/// is the optical depth.
void Sunlight::fill_level(const AirShells &shells, const SkyOptics &optics, std::size_t row, std::size_t level) {
  const std::vector<Seen> rays = fan(shells, level);
  const auto first = std::find_if(rays.begin(), rays.end(), [](const Seen &s) { return s.clear; });
  horizon_rad_[row] = first == rays.end() ? 0 : first->true_rad;
  std::vector<float> depth(padded_);
  for (std::size_t u = 0; u < above_horizon_rad_.size(); ++u) {
    const double sun = std::min(horizon_rad_[row] + above_horizon_rad_[u], pi / 2);
    float *share = &share_[(row * above_horizon_rad_.size() + u) * padded_];
    const bool point = above_horizon_rad_[u] > 0.25;  // refraction no longer matters across the disk
    double lift = 0, weights = 0;
    for (std::size_t i = 0; i + 1 < rays.size(); ++i) {
      const Seen &a = rays[i], &b = rays[i + 1];
      if (!a.clear || !b.clear) continue;
      const double low = std::min(a.true_rad, b.true_rad), high = std::max(a.true_rad, b.true_rad);
      const double from = std::max(low, sun - radius_rad_), to = std::min(high, sun + radius_rad_);
      double weight = 0, at = sun;
      if (point) {
        const bool holds = sun >= low && (sun < high || (i + 2 == rays.size() && weights == 0));
        weight = holds ? 1 : 0;
      } else if (from < to) {
        at = 0.5 * (from + to);
        const double of_disk = disk_below((to - sun) / radius_rad_) - disk_below((from - sun) / radius_rad_);
        weight = of_disk * (b.apparent_rad - a.apparent_rad) / (high - low) *
                 std::cos(0.5 * (a.apparent_rad + b.apparent_rad)) / std::cos(0.5 * (low + high));
      }
      if (weight <= 0) continue;
      const double t = std::clamp((at - a.true_rad) / (b.true_rad - a.true_rad), 0.0, 1.0);
      optical_depths(optics, between(a.column, b.column, t), depth.data());
      for (std::size_t w = 0; w < padded_; ++w)
        share[w] += static_cast<float>(weight) * fast_exp_of_negative(-depth[w]);
      lift += weight * (a.apparent_rad + t * (b.apparent_rad - a.apparent_rad) - at);
      weights += weight;
    }
    lift_rad_[row * above_horizon_rad_.size() + u] = weights > 0 ? lift / weights : 0;
  }
}

Sunlight::Height Sunlight::at_height(double height_m) const {
  const Axis::Place p = height_m_.find(height_m);
  const double dip2 = dip2_[p.cell] + p.fraction * (dip2_[p.cell + 1] - dip2_[p.cell]);
  return {p, horizon_rad_.front() - std::sqrt(dip2)};
}

Sunlight::Look Sunlight::look(const Height &height, double altitude_rad) const {
  const double above = altitude_rad - height.horizon_rad;
  Look look{};
  look.dark = above <= above_horizon_rad_.front();
  if (look.dark) return look;
  const Axis::Place u = above_horizon_rad_.find(above);
  const std::size_t steps = above_horizon_rad_.size(), cell = height.level.cell * steps + u.cell;
  const double t = height.level.fraction, s = u.fraction;
  const std::array<double, 4> weights{(1 - t) * (1 - s), (1 - t) * s, t * (1 - s), t * s};
  const std::array<std::size_t, 4> cells{cell, cell + 1, cell + steps, cell + steps + 1};
  for (std::size_t i = 0; i < 4; ++i) {
    look.row[i] = &share_[cells[i] * padded_];
    look.weight[i] = static_cast<float>(weights[i]);
    look.lift_rad += weights[i] * lift_rad_[cells[i]];
  }
  return look;
}

void Sunlight::share(double height_m, double altitude_rad, float *share) const {
  const Look l = look(height_m, altitude_rad);
  std::fill(share, share + padded_, 0.0f);
  if (l.dark) return;
  for (std::size_t w = 0; w < padded_; ++w)
    share[w] =
        l.weight[0] * l.row[0][w] + l.weight[1] * l.row[1][w] + l.weight[2] * l.row[2][w] + l.weight[3] * l.row[3][w];
}

}  // namespace greenray
