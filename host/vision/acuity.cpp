#include "vision/acuity.hpp"

#include <algorithm>
#include <cmath>

namespace greenray::vision {

double acuity_cycles_deg(double adaptation_cd_m2) {
  const double level = std::log10(std::max(adaptation_cd_m2, 1e-7));
  return 17.25 * std::atan(1.4 * level + 0.35) + 25.72;
}

double cone_share(double luminance_cd_m2) {
  constexpr double bottom = 5.62e-3;
  return std::clamp((luminance_cd_m2 - bottom) / (top_of_mesopic_cd_m2 - bottom), 0.0, 1.0);
}

double scotopic_from_xyz(double x, double y, double z) {
  if (!(x > 0)) return 0;
  return std::max(0.0, y * (1.33 * (1 + (y + z) / x) - 1.68));
}

Mesopic cie191(double photopic_cd_m2, double scotopic_cd_m2) {
  constexpr double c = 683.0 / 1699.0;
  double m = 0.5, luminance = 0;
  for (int i = 0; i < 100; ++i) {
    luminance = (m * photopic_cd_m2 + (1 - m) * scotopic_cd_m2 * c) / (m + (1 - m) * c);
    const double next = luminance > 0 ? std::clamp(0.7670 + 0.3334 * std::log10(luminance), 0.0, 1.0) : 0.0;
    if (std::abs(next - m) < 1e-9) break;
    m = next;
  }
  return {luminance, m};
}

}  // namespace greenray::vision
