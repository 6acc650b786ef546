#include "atmosphere/refractivity.hpp"

namespace greenray {
namespace {

constexpr double ice_point_K = 273.15;
constexpr double atmosphere_Pa = 101325.0;

double square(double x) { return x * x; }

// Ciddor 1996, appendix A. sigma is the vacuum wavenumber [1/um].
constexpr double co2_ppm = 450.0;
double ciddor_dry_axs(double sigma2) {  // dry air at 15 C, 101325 Pa, eqs 1 and 2
  const double at_450 = 1e-8 * (5792105.0 / (238.0185 - sigma2) + 167917.0 / (57.362 - sigma2));
  return at_450 * (1 + 0.534e-6 * (co2_ppm - 450));
}
double ciddor_vapour_vs(double sigma2) {  // pure vapour at 20 C, 1333 Pa, eq 3
  return 1.022e-8 * (295.235 + sigma2 * (2.6422 + sigma2 * (-0.032380 + sigma2 * 0.004028)));
}

/// Compressibility of moist air, Ciddor 1996 eq 12 (BIPM 1981/91). mole_fraction of vapour.
Dual compressibility(Dual temperature_K, Dual pressure_Pa, Dual mole_fraction) {
  const Dual t = temperature_K - ice_point_K, over = pressure_Pa / temperature_K;
  const Dual x = mole_fraction;
  const Dual first = Dual(1.58123e-6) + t * (Dual(-2.9331e-8) + t * 1.1043e-10) + x * (Dual(5.707e-6) + t * -2.051e-8) +
                     x * x * (Dual(1.9898e-4) + t * -2.376e-6);
  return Dual(1) - over * first + over * over * (Dual(1.83e-11) + x * x * -0.765e-8);
}

/// Ciddor 1996 eq 4: density of one component [kg/m^3] of air with that vapour fraction (eq 4: p M/(Z R T) ...).
constexpr double gas_constant = 8.314510;
constexpr double vapour_molar_kg = 0.018015;
constexpr double dry_molar_kg = 1e-3 * (28.9635 + 12.011e-6 * (co2_ppm - 400));
Dual component_density(Dual temperature_K, Dual pressure_Pa, Dual mole_fraction, Dual share, double molar_kg) {
  const Dual z = compressibility(temperature_K, pressure_Pa, mole_fraction);
  return pressure_Pa * molar_kg / (z * gas_constant * temperature_K) * share;
}

Dual ciddor(double wavelength_nm, const AirState &air) {
  const double sigma2 = square(1e3 / wavelength_nm);
  const Dual x = air.pressure_Pa.value > 0 ? air.vapour_Pa / air.pressure_Pa : Dual(0);
  const Dual dry = component_density(air.temperature_K, air.pressure_Pa, x, Dual(1) - x, dry_molar_kg);
  const Dual wet = component_density(air.temperature_K, air.pressure_Pa, x, x, vapour_molar_kg);
  static const double dry_axs = component_density(288.15, atmosphere_Pa, 0.0, 1.0, dry_molar_kg).value;
  static const double wet_vs = component_density(293.15, 1333.0, 1.0, 1.0, vapour_molar_kg).value;
  return dry * (ciddor_dry_axs(sigma2) / dry_axs) + wet * (ciddor_vapour_vs(sigma2) / wet_vs);
}

}  // namespace

double reference_refractivity(IndexModel model, double wavelength_nm) {
  const double um2 = square(wavelength_nm * 1e-3), sigma2 = 1 / um2;
  switch (model) {
    case IndexModel::born_wolf:
      return 28.79e-5 * (1 + 5.67e-3 / um2);
    case IndexModel::iag1999:
      return 1e-6 * (287.6155 + sigma2 * (1.62887 + sigma2 * 0.01360));
    case IndexModel::peck_reeder:
      return 1e-8 * (5791817.0 / (238.0183 - sigma2) + 167909.0 / (57.362 - sigma2));
    case IndexModel::ciddor:
      return ciddor_dry_axs(sigma2);
  }
  return 0;
}

Dual refractivity(IndexModel model, double wavelength_nm, const AirState &air) {
  if (model == IndexModel::ciddor) return ciddor(wavelength_nm, air);
  const double reference_K = model == IndexModel::peck_reeder ? 288.15 : ice_point_K;
  const Dual density_ratio = air.pressure_Pa * (1 / atmosphere_Pa) * Dual(reference_K) / air.temperature_K;
  const Dual dry = density_ratio * reference_refractivity(model, wavelength_nm);
  if (model != IndexModel::iag1999) return dry;
  return dry - Dual(11.27e-8) * air.vapour_Pa / air.temperature_K;  // IAG 1999: -11.27e-6 e[hPa]/T
}

Dual saturation_vapour_Pa(Dual temperature_K, Dual pressure_Pa) {
  const Dual t = temperature_K - ice_point_K;
  const Dual pure = exp(temperature_K * (temperature_K * 1.2378847e-5 - 1.9121316e-2) + 33.93711047 -
                        Dual(6.3431645e3) / temperature_K);
  return pure * (Dual(1.00062) + pressure_Pa * 3.14e-8 + t * t * 5.6e-7);
}

}  // namespace greenray
