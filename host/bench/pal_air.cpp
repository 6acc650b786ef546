#include "bench/pal_air.hpp"

#include <cmath>

namespace greenray::bench {
namespace {

constexpr double radius_m = 6378120, tropopause_m = 11000, top_m = 80000;
constexpr double gas_constant = 8314.32, molar_mass = 28.9644;  // J/(kmol K), kg/kmol

class PalAir {
 public:
  explicit PalAir(const PalSite &s) : site_(s) {
    const double gravity = 9.784 * (1 - 0.0026 * std::cos(2 * s.latitude_rad) - 0.00000028 * s.eye_m);
    hydrostatic_K_m_ = gravity * molar_mass / gas_constant;
    power_ = hydrostatic_K_m_ / s.lapse_K_m - 1;
    const double per_um2 = 1 / (s.wavelength_um * s.wavelength_um);
    const double standard = 1e-6 * (287.6155 + per_um2 * (1.62887 + per_um2 * 0.01360));  // 0 C, 1013.25 hPa
    at_eye_ = standard * (s.pressure_hPa / 1013.25) * (273.15 / s.temperature_K);
  }

  Dual refractivity(double height_m) const {
    if (height_m < tropopause_m) return troposphere(height_m);
    const double per_m = hydrostatic_K_m_ / temperature_K(tropopause_m);
    const double value = troposphere(tropopause_m).value * std::exp(-per_m * (height_m - tropopause_m));
    return {value, -per_m * value};
  }

 private:
  double temperature_K(double height_m) const {
    return site_.temperature_K - site_.lapse_K_m * (height_m - site_.eye_m);
  }
  Dual troposphere(double height_m) const {
    const double ratio = temperature_K(height_m) / site_.temperature_K;
    return {at_eye_ * std::pow(ratio, power_),
            -at_eye_ * power_ * std::pow(ratio, power_ - 1) * site_.lapse_K_m / site_.temperature_K};
  }

  PalSite site_;
  double hydrostatic_K_m_, power_, at_eye_;  // g M/R; of T; n - 1
};

}  // namespace

LayeredMedium pal_air(const PalSite &site) {
  const PalAir air(site);
  LayeredMedium medium;
  medium.refractivity = [air](double height_m, double) { return air.refractivity(height_m); };
  medium.density_kg_m3 = [air](double height_m) { return air.refractivity(height_m).value / 2.27e-4; };  // dry air
  medium.kinks_m = {tropopause_m};
  medium.top_m = top_m;
  medium.radius_m = radius_m;
  return medium;
}

}  // namespace greenray::bench
