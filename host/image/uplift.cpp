#include "image/uplift.hpp"

#include <algorithm>
#include <cmath>

#include "support/csv_table.hpp"

namespace greenray {
namespace {

constexpr double first_nm = 360, last_nm = 830, step_nm = 5;

double sigmoid(double x) { return 0.5 + x / (2 * std::sqrt(1 + x * x)); }

/// x of the sigmoid for a value in (0, 1).
double inverse_sigmoid(double value) {
  const double y = 2 * std::clamp(value, 1e-4, 1 - 1e-4) - 1;
  return y / std::sqrt(1 - y * y);
}

/// Solves a 3x3 system by Cramer's rule.
std::array<double, 3> solved(const std::array<Rgb, 3> &column, const Rgb &right) {
  const auto det = [](const Rgb &a, const Rgb &b, const Rgb &c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - b[0] * (a[1] * c[2] - a[2] * c[1]) + c[0] * (a[1] * b[2] - a[2] * b[1]);
  };
  const double d = det(column[0], column[1], column[2]);
  if (!(std::abs(d) > 1e-300)) return {0, 0, 0};
  return {det(right, column[1], column[2]) / d, det(column[0], right, column[2]) / d,
          det(column[0], column[1], right) / d};
}

double distance(const Rgb &a, const Rgb &b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

}  // namespace

double curve_place(double wavelength_nm) { return (wavelength_nm - first_nm) / (last_nm - first_nm); }

double curve_value(const CurveCoefficients &c, double wavelength_nm) {
  const double t = curve_place(wavelength_nm);
  return sigmoid((c[0] * t + c[1]) * t + c[2]);
}

Uplift::Uplift() {
  const CsvTable d65 = CsvTable::embedded("host/data/cie_d65_5nm.csv");
  Rgb white{};
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    const double nm = first_nm + step_nm * static_cast<double>(i);
    const double light = d65.interpolate("nm", "S", nm, CsvTable::Outside::zero);
    const Xyz xyz = colour_matching(nm);
    weight_[i] = rgb_from_xyz({light * xyz[0], light * xyz[1], light * xyz[2]});
    for (std::size_t c = 0; c < 3; ++c) white[c] += weight_[i][c];
  }
  for (Rgb &w : weight_)
    for (std::size_t c = 0; c < 3; ++c) w[c] /= white[c];
}

Rgb Uplift::colour(const CurveCoefficients &c) const {
  Rgb sum{};
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    const double value = curve_value(c, first_nm + step_nm * static_cast<double>(i));
    for (std::size_t k = 0; k < 3; ++k) sum[k] += weight_[i][k] * value;
  }
  return sum;
}

CurveCoefficients Uplift::solve(const Rgb &target) const {
  const double grey = std::clamp(luminance(target), 0.0, 1.0);
  CurveCoefficients c{0, 0, inverse_sigmoid(grey)};
  constexpr int stages = 6;
  for (int stage = 1; stage <= stages; ++stage) {
    const double mix = static_cast<double>(stage) / stages;
    Rgb aim{};
    for (std::size_t k = 0; k < 3; ++k) aim[k] = grey + mix * (target[k] - grey);
    for (int i = 0; i < 12; ++i) {
      const Rgb now = colour(c);
      const double off = distance(now, aim);
      if (off < 1e-6) break;
      std::array<Rgb, 3> slope{};
      for (std::size_t k = 0; k < 3; ++k) {
        CurveCoefficients nudged = c;
        nudged[k] += 1e-4;
        const Rgb there = colour(nudged);
        for (std::size_t j = 0; j < 3; ++j) slope[k][j] = (there[j] - now[j]) / 1e-4;
      }
      const auto step = solved(slope, {aim[0] - now[0], aim[1] - now[1], aim[2] - now[2]});
      double share = 1;
      CurveCoefficients next = c;
      for (; share > 1e-3; share /= 2) {
        for (std::size_t k = 0; k < 3; ++k) next[k] = std::clamp(c[k] + share * step[k], -500.0, 500.0);
        if (distance(colour(next), aim) < off) break;
      }
      if (share <= 1e-3) break;
      c = next;
    }
  }
  return c;
}

CurveCoefficients Uplift::coefficients(const Rgb &linear) {
  std::array<int, 3> key{};
  for (std::size_t k = 0; k < 3; ++k) key[k] = static_cast<int>(std::lround(4096 * std::clamp(linear[k], 0.0, 1.0)));
  const auto known = known_.find(key);
  if (known != known_.end()) return known->second;
  const Rgb target{key[0] / 4096.0, key[1] / 4096.0, key[2] / 4096.0};
  const bool is_grey = key[0] == key[1] && key[1] == key[2];
  return known_[key] = is_grey ? CurveCoefficients{0, 0, inverse_sigmoid(target[0])} : solve(target);
}

}  // namespace greenray
