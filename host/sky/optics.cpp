#include "sky/optics.hpp"

#include <cmath>

#include "support/angle.hpp"
#include "support/fast_math.hpp"

namespace greenray {

double rayleigh_anisotropy(double wavelength_nm) {
  const double w2 = std::pow(1e3 / wavelength_nm, 2);  // 1/um^2
  const double nitrogen = 1.034 + 3.17e-4 * w2, oxygen = 1.096 + 1.385e-3 * w2 + 1.448e-4 * w2 * w2;
  const double argon = 1, carbon_dioxide = 1.15;
  const double king = (78.084 * nitrogen + 20.946 * oxygen + 0.934 * argon + 0.036 * carbon_dioxide) / 100;
  const double depolarisation = 6 * (king - 1) / (3 + 7 * king);
  return depolarisation / (2 - depolarisation);
}

RayleighPhase rayleigh_phase(double anisotropy) {
  const double scale = 3 / (16 * pi) / (1 + 2 * anisotropy);
  return {scale * (1 + 3 * anisotropy), scale * (1 - anisotropy)};
}

double aerosol_phase(double cosine, double asymmetry) {
  const double g = asymmetry, denominator = 1 + g * g - 2 * g * cosine;
  return (1 - g * g) / (4 * pi * denominator * std::sqrt(denominator));
}

GREENRAY_VECTOR_CLONES
void optical_depths(const SkyOptics &optics, const Columns &columns, float *depth) {
  const float air = static_cast<float>(columns.air), ozone = static_cast<float>(columns.ozone),
              aerosol = static_cast<float>(columns.aerosol);
  const float *r = optics.rayleigh_per_kg_m2.data(), *o = optics.ozone_per_m.data(), *a = optics.aerosol_per_m.data();
  const std::size_t n = optics.padded();
  for (std::size_t w = 0; w < n; ++w) depth[w] = air * r[w] + ozone * o[w] + aerosol * a[w];
}

}  // namespace greenray
