// T(h) of a profile: base, levels, inversions, surface layers, smoothing. No pressure, no light.
#pragma once
#include <utility>
#include <vector>

#include "atmosphere/dual.hpp"
#include "atmosphere/profile_spec.hpp"

namespace greenray {

/// Interpolates rows (height, value): linear, or monotone cubic (Fritsch & Carlson 1980). Constant outside the rows.
class LevelCurve {
 public:
  LevelCurve() = default;
  LevelCurve(std::vector<double> height_m, std::vector<double> value, Interpolation interpolation);
  bool empty() const { return height_m_.empty(); }
  double top_m() const { return height_m_.back(); }
  const std::vector<double> &heights_m() const { return height_m_; }
  /// Value and slope; at a row the slope is that of the interval above.
  Dual operator()(double height_m) const;

 private:
  std::vector<double> height_m_, value_, slope_;  // slope_ empty: linear
};

class TemperatureCurve {
 public:
  explicit TemperatureCurve(const ProfileSpec &spec);

  /// T [K] and dT/dh [K/m] at a geometric height >= 0; at a kink, of the side above.
  Dual operator()(double height_m) const;

  /// Heights where T or its slope jumps: table cells and quadrature panels end here.
  const std::vector<double> &kinks_m() const { return kinks_m_; }
  /// Heights near which T changes quickly though smoothly (inversions, surface layers): hints to quadrature panels.
  const std::vector<double> &features_m() const { return features_m_; }

 private:
  Dual unsmoothed(double height_m) const;
  Dual smoothed(double height_m) const;
  void find_kinks();
  void find_own_kinks();
  void find_features();

  /// What the inversions and surface layers of this profile are added to.
  Dual base(double height_m) const;

  std::vector<std::pair<double, TemperatureCurve>> shares_;  // of a blend: weight and curve
  LevelCurve levels_;
  double shift_above_K_ = 0;
  std::vector<InversionSpec> inversions_;
  std::vector<SurfaceLayerSpec> layers_;
  double smooth_m_ = 0;
  std::vector<double> kinks_m_, raw_kinks_m_, features_m_;
};

}  // namespace greenray
