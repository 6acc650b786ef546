#include "image/svg_scale.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace greenray {
namespace {

std::string power_of_ten(int exponent) {
  static const std::array<const char *, 10> digit{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char c : std::to_string(std::abs(exponent))) text += digit[static_cast<std::size_t>(c - '0')];
  return text;
}

}  // namespace

std::vector<double> linear_ticks(double low, double high, int wanted) {
  std::vector<double> ticks;
  if (!(high > low) || !std::isfinite(high - low) || wanted < 1) return ticks;
  const double rough = (high - low) / wanted, decade = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * decade;
  for (const double nice : {5.0, 2.0, 1.0})
    if (nice * decade >= rough * (1 - 1e-9)) step = nice * decade;
  const double first = std::ceil(low / step - 1e-9);
  for (int i = 0; i <= wanted + 1 && (first + i) * step <= high + 1e-9 * step; ++i) ticks.push_back((first + i) * step);
  return ticks;
}

PlotScale::PlotScale(const PlotAxis &axis, const std::vector<double> &values) : axis_(axis) {
  find_limits(values);
  axis_.log ? lay_log_ticks() : lay_linear_ticks();
}

double PlotScale::at(double value) const {
  if (!std::isfinite(value) || (axis_.log && value <= 0)) return std::nan("");
  return axis_.log ? std::log(value / low_) / std::log(high_ / low_) : (value - low_) / (high_ - low_);
}

std::string PlotScale::title() const {
  const std::string factor = exponent_ == 0 ? "" : power_of_ten(exponent_);
  const std::string unit = factor + (factor.empty() || axis_.unit.empty() ? "" : " ") + axis_.unit;
  return axis_.label + (unit.empty() ? "" : " [" + unit + "]");
}

void PlotScale::find_limits(const std::vector<double> &values) {
  bool any = false;
  for (const double v : values) {
    if (!std::isfinite(v) || (axis_.log && v <= 0)) continue;
    low_ = any ? std::min(low_, v) : v;
    high_ = any ? std::max(high_, v) : v;
    any = true;
  }
  if (!any) low_ = axis_.log ? 1 : 0, high_ = axis_.log ? 10 : 1;
  const auto usable = [this](std::optional<double> v) { return v && std::isfinite(*v) && (!axis_.log || *v > 0); };
  const bool fixed_low = usable(axis_.low), fixed_high = usable(axis_.high);
  if (fixed_low) low_ = *axis_.low;
  if (fixed_high) high_ = *axis_.high;
  low_ = std::clamp(low_, axis_.log ? 1e-300 : -1e300, 1e300);
  high_ = std::clamp(high_, axis_.log ? 1e-300 : -1e300, 1e300);
  if (!(high_ > low_)) widen();
  if (axis_.log) {
    if (high_ < low_ * 1.05) low_ /= 1.05, high_ *= 1.05;
    return;
  }
  if (high_ - low_ < 1e-9 * std::max(std::abs(low_), std::abs(high_))) widen();
  const double margin = 0.04 * (high_ - low_);
  if (!fixed_low) low_ -= margin;
  if (!fixed_high) high_ += margin;
}

void PlotScale::widen() {
  const double middle = axis_.log ? std::max(low_, 1e-290) : low_;
  const double by = axis_.log ? 0 : std::max(std::abs(middle) * 1e-3, 1e-12);
  low_ = axis_.log ? middle / 1.5 : middle - by;
  high_ = axis_.log ? middle * 1.5 : middle + by;
}

void PlotScale::lay_linear_ticks() {
  const double largest = std::max(std::abs(low_), std::abs(high_));
  const int magnitude = static_cast<int>(std::floor(std::log10(largest)));
  if (magnitude >= 5 || magnitude <= -4) exponent_ = magnitude;
  const std::vector<double> values = linear_ticks(low_, high_);
  const double unit = std::pow(10.0, exponent_);
  const double step = values.size() > 1 ? (values[1] - values[0]) / unit : 1;
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-6)), 0, 12);
  for (const double v : values) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", decimals, v == 0 ? 0.0 : v / unit);
    ticks_.push_back({v, text[0] == '-' ? "−" + std::string(text + 1) : text});
  }
}

void PlotScale::lay_log_ticks() {
  const int first = static_cast<int>(std::floor(std::log10(low_) - 1e-9));
  const int last = static_cast<int>(std::ceil(std::log10(high_) + 1e-9));
  const double decades = std::log10(high_ / low_);
  if (decades < 0.7) return lay_linear_ticks();
  const int stride = std::max(1, (last - first) / 8);
  for (int d = first; d <= last; ++d)
    for (int m = 1; m <= 9; ++m) {
      const double v = m * std::pow(10.0, d);
      if (v < low_ * (1 - 1e-9) || v > high_ * (1 + 1e-9)) continue;
      const bool named = m == 1 ? (d - first) % stride == 0 : decades < 2 && (m == 2 || m == 5);
      if (named) ticks_.push_back({v, (m == 1 ? "" : std::to_string(m) + "·") + power_of_ten(d)});
      else if (decades < 8) ticks_.push_back({v, ""});
    }
}

}  // namespace greenray
