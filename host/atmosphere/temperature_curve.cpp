#include "atmosphere/temperature_curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "atmosphere/gauss_hermite.hpp"
#include "atmosphere/gauss_legendre.hpp"
#include "atmosphere/standard_atmosphere.hpp"

namespace greenray {

/// Fritsch & Carlson, SIAM J. Numer. Anal. 17 (1980) 238: weighted harmonic mean of neighbouring secants, 0 at extrema.
static std::vector<double> monotone_slopes(const std::vector<double> &h, const std::vector<double> &v) {
  const std::size_t n = h.size();
  std::vector<double> secant(n - 1), slope(n);
  for (std::size_t i = 0; i + 1 < n; ++i) secant[i] = (v[i + 1] - v[i]) / (h[i + 1] - h[i]);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double below = h[i] - h[i - 1], above = h[i + 1] - h[i];
    const double w1 = 2 * above + below, w2 = above + 2 * below;
    slope[i] = secant[i - 1] * secant[i] > 0 ? (w1 + w2) / (w1 / secant[i - 1] + w2 / secant[i]) : 0.0;
  }
  // One-sided three-point ends, limited so that the curve stays monotone.
  const auto end_slope = [](double h0, double h1, double d0, double d1) {
    const double s = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
    if (s * d0 <= 0) return 0.0;
    return d0 * d1 <= 0 && std::abs(s) > 3 * std::abs(d0) ? 3 * d0 : s;
  };
  slope[0] = n > 2 ? end_slope(h[1] - h[0], h[2] - h[1], secant[0], secant[1]) : secant[0];
  slope[n - 1] = n > 2 ? end_slope(h[n - 1] - h[n - 2], h[n - 2] - h[n - 3], secant[n - 2], secant[n - 3]) : secant[0];
  return slope;
}

LevelCurve::LevelCurve(std::vector<double> height_m, std::vector<double> value, Interpolation interpolation)
    : height_m_(std::move(height_m)), value_(std::move(value)) {
  if (interpolation == Interpolation::cubic && height_m_.size() >= 2) slope_ = monotone_slopes(height_m_, value_);
}

Dual LevelCurve::operator()(double height_m) const {
  if (height_m < height_m_.front()) return value_.front();
  if (height_m >= height_m_.back()) return value_.back();
  const auto above = std::upper_bound(height_m_.begin(), height_m_.end(), height_m);
  const std::size_t i = static_cast<std::size_t>(above - height_m_.begin()) - 1;
  const double width = height_m_[i + 1] - height_m_[i], secant = (value_[i + 1] - value_[i]) / width;
  const double x = height_m - height_m_[i];
  if (slope_.empty()) return {value_[i] + secant * x, secant};
  const double c = (3 * secant - 2 * slope_[i] - slope_[i + 1]) / width;
  const double d = (slope_[i] + slope_[i + 1] - 2 * secant) / (width * width);
  return {value_[i] + x * (slope_[i] + x * (c + x * d)), slope_[i] + x * (2 * c + x * 3 * d)};
}

TemperatureCurve::TemperatureCurve(const ProfileSpec &spec)
    : inversions_(spec.inversions), layers_(spec.surface_layers), smooth_m_(spec.smooth_m) {
  if (!spec.levels.empty()) {
    std::vector<double> height_m, temperature_K;
    for (const Level &level : spec.levels) {
      height_m.push_back(level.height_m);
      temperature_K.push_back(level.temperature_K);
    }
    shift_above_K_ = temperature_K.back() - us76::temperature_K(height_m.back()).value;
    levels_ = LevelCurve(std::move(height_m), std::move(temperature_K), spec.interpolation);
  }
  for (const AirShare &share : spec.blend) shares_.emplace_back(share.weight, TemperatureCurve(*share.air));
  find_kinks();
}

void TemperatureCurve::find_kinks() {
  for (const auto &[weight, curve] : shares_) {
    raw_kinks_m_.insert(raw_kinks_m_.end(), curve.kinks_m_.begin(), curve.kinks_m_.end());
    features_m_.insert(features_m_.end(), curve.features_m_.begin(), curve.features_m_.end());
  }
  if (shares_.empty()) find_own_kinks();
  std::sort(raw_kinks_m_.begin(), raw_kinks_m_.end());
  raw_kinks_m_.erase(std::unique(raw_kinks_m_.begin(), raw_kinks_m_.end()), raw_kinks_m_.end());
  if (smooth_m_ <= 0) kinks_m_ = raw_kinks_m_;
  find_features();
}

void TemperatureCurve::find_own_kinks() {
  for (const us76::Layer &layer : us76::layers) {
    const double height_m = us76::geometric_m(layer.base_gpm);
    if (layer.base_gpm > 0 && (levels_.empty() || height_m > levels_.top_m())) raw_kinks_m_.push_back(height_m);
  }
  if (!levels_.empty())
    for (double height_m : levels_.heights_m())
      if (height_m > 0) raw_kinks_m_.push_back(height_m);
}

void TemperatureCurve::find_features() {
  const auto feature = [this](double height_m) {
    if (height_m > 0 && height_m < us76::air_top_m) features_m_.push_back(height_m);
  };
  for (const InversionSpec &v : inversions_)
    for (int k = -40; k <= 40; k += 2) feature(v.height_m.constant() + k * v.diffuseness_m.constant());
  for (const SurfaceLayerSpec &layer : layers_)
    for (int k = 1; k <= 40; ++k) feature(k * layer.scale_m);
  if (smooth_m_ > 0)
    for (double kink : raw_kinks_m_)
      for (int k = -8; k <= 8; ++k) feature(kink + k * smooth_m_);
  std::sort(features_m_.begin(), features_m_.end());
}

Dual TemperatureCurve::base(double height_m) const {
  if (!shares_.empty()) {
    Dual t;
    for (const auto &[weight, curve] : shares_) t = t + Dual(weight) * curve(height_m);
    return t;
  }
  if (levels_.empty()) return us76::temperature_K(height_m);
  if (height_m >= levels_.top_m()) return us76::temperature_K(height_m) + Dual(shift_above_K_);
  return levels_(height_m);
}

Dual TemperatureCurve::unsmoothed(double height_m) const {
  Dual t = base(height_m);
  for (const InversionSpec &v : inversions_) {  // G04 4.4: -dT + dT/(1+exp(-x)) = -dT/(1+exp(x))
    const double width = v.diffuseness_m.constant(), jump = v.delta_T_K.constant();
    const double x = std::clamp((height_m - v.height_m.constant()) / width, -700.0, 700.0);
    const double below = 1 / (1 + std::exp(x)), above = 1 / (1 + std::exp(-x));
    t = t + Dual(-jump * below, jump * below * above / width);
  }
  for (const SurfaceLayerSpec &layer : layers_) {
    const double excess = layer.delta_T_K * std::exp(-height_m / layer.scale_m);
    t = t + Dual(excess, -excess / layer.scale_m);
  }
  return t;
}

/// Any of these heights, ascending, within the reach of a place.
static bool any_near(const std::vector<double> &heights_m, double height_m, double reach_m) {
  const auto from = std::lower_bound(heights_m.begin(), heights_m.end(), height_m - reach_m);
  return from != heights_m.end() && *from <= height_m + reach_m;
}

/// The Gauss-Hermite rule that is enough for the mean over layers no thinner than this; none where only panels are. A
/// Fermi step's poles lie pi widths off the real axis, so that n points are good to exp(-2 sqrt(n) pi width/sigma):
/// 1e-16 with 12 where width >= 2 sigma, with 40 where width >= sigma.
static const GaussHermite *hermite_rule(double thinnest_in_sigma) {
  static const GaussHermite few(12), many(40);
  return thinnest_in_sigma >= 2 ? &few : thinnest_in_sigma >= 1 ? &many : nullptr;
}

/// Gaussian mean over +-7 sigma; below the ground T continues with the slope it has there.
Dual TemperatureCurve::smoothed(double height_m) const {
  const double reach = 7 * smooth_m_;
  if (height_m >= reach && !any_near(raw_kinks_m_, height_m, reach)) {
    double thinnest_m = std::numeric_limits<double>::infinity();
    if (any_near(features_m_, height_m, reach)) {
      if (!shares_.empty()) thinnest_m = 0;  // as thin as the blended airs have them
      for (const InversionSpec &v : inversions_) thinnest_m = std::min(thinnest_m, v.diffuseness_m.constant());
      for (const SurfaceLayerSpec &layer : layers_) thinnest_m = std::min(thinnest_m, layer.scale_m);
    }
    if (const GaussHermite *rule = hermite_rule(thinnest_m / smooth_m_)) {
      Dual sum;
      for (std::size_t k = 0; k < rule->node.size(); ++k)
        sum = sum + Dual(rule->weight[k]) * unsmoothed(height_m + smooth_m_ * rule->node[k]);
      return sum;
    }
  }
  std::vector<double> edges{-reach};
  const auto add_between = [&](const std::vector<double> &heights) {
    const auto from = std::lower_bound(heights.begin(), heights.end(), height_m - reach);
    for (auto it = from; it != heights.end() && *it < height_m + reach; ++it) edges.push_back(*it - height_m);
  };
  for (int k = -6; k <= 7; ++k) edges.push_back(k * smooth_m_);
  add_between(raw_kinks_m_);
  if (height_m < reach) edges.push_back(-height_m);
  if (!inversions_.empty() || !layers_.empty()) add_between(features_m_);
  std::sort(edges.begin(), edges.end());

  const Dual ground = height_m < reach ? unsmoothed(0) : Dual();
  const double scale = 1 / (smooth_m_ * std::sqrt(2 * M_PI));
  Dual sum;
  double weight_sum = 0;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const double middle = 0.5 * (edges[i] + edges[i + 1]), half = 0.5 * (edges[i + 1] - edges[i]);
    if (half <= 0) continue;
    for (std::size_t k = 0; k < 2 * legendre_node.size(); ++k) {
      const double x = middle + (k % 2 ? half : -half) * legendre_node[k / 2], h = height_m + x;
      const double weight = half * legendre_weight[k / 2] * scale * std::exp(-0.5 * x * x / (smooth_m_ * smooth_m_));
      const Dual t = h >= 0 ? unsmoothed(h) : Dual(ground.value + h * ground.slope, ground.slope);
      sum = sum + Dual(weight) * t;
      weight_sum += weight;
    }
  }
  return sum / Dual(weight_sum);
}

Dual TemperatureCurve::operator()(double height_m) const {
  return smooth_m_ > 0 ? smoothed(height_m) : unsmoothed(height_m);
}

}  // namespace greenray
