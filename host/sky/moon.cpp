#include "sky/moon.hpp"

#include <algorithm>
#include <cmath>

#include "support/angle.hpp"

namespace greenray {

double lunar_albedo(double wavelength_nm) { return 0.12 * (1 + 0.0019 * (wavelength_nm - 550)); }

double lommel_seeliger_phase(double phase_rad) {
  const double a = std::clamp(std::abs(phase_rad), 1e-9, pi - 1e-9);
  return 1 - std::sin(a / 2) * std::tan(a / 2) * std::log(1 / std::tan(a / 4));
}

double lunar_phase_factor(double phase_rad) {
  const double a = std::min(std::abs(to_deg(phase_rad)), 170.0);  // beyond, the law is a guess and the crescent thin
  const double magnitudes = 0.026 * a + 4e-9 * std::pow(a, 4);
  return std::pow(10, -0.4 * magnitudes) / lommel_seeliger_phase(to_rad(a));
}

}  // namespace greenray
