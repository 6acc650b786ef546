// Axes of a plot: limits, ticks and their labels. A part of svg.cpp.
#pragma once
#include <string>
#include <vector>

#include "image/svg.hpp"

namespace greenray {

struct PlotTick {
  double value;
  std::string label;  // "" for a minor one
};

/// An axis with limits and ticks settled; maps values to 0..1.
class PlotScale {
 public:
  /// values: those of the lines, for limits that `axis` leaves open; what is not finite is ignored.
  PlotScale(const PlotAxis &axis, const std::vector<double> &values);
  /// 0 at the low end, 1 at the high end; NaN for what the axis cannot show.
  double at(double value) const;
  const std::vector<PlotTick> &ticks() const { return ticks_; }
  /// "pressure [10⁵ Pa]"
  std::string title() const;

 private:
  void find_limits(const std::vector<double> &values);
  void widen();
  void lay_linear_ticks();
  void lay_log_ticks();

  PlotAxis axis_;
  double low_ = 0, high_ = 1;
  int exponent_ = 0;
  std::vector<PlotTick> ticks_;
};

}  // namespace greenray
