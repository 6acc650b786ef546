// US Standard Atmosphere 1976 up to 84.852 geopotential km, isothermal above.
#pragma once
#include <array>

#include "atmosphere/dual.hpp"

namespace greenray::us76 {

inline constexpr double earth_radius_m = 6356766.0;       // r0 of the geopotential
inline constexpr double gas_constant_J_kmol_K = 8314.32;  // R*, the 1976 value
inline constexpr double molar_mass_kg_kmol = 28.9644;     // M0
inline constexpr double gravity_m_s2 = 9.80665;           // g0
inline constexpr double hydrostatic_K_m = gravity_m_s2 * molar_mass_kg_kmol / gas_constant_J_kmol_K;  // g0 M0 / R*
inline constexpr double air_top_m = 120000.0;  // geometric; above is vacuum

struct Layer {
  double base_gpm;  // geopotential metres
  double base_K;
  double lapse_K_gpm;
};
inline constexpr std::array<Layer, 8> layers{{{0, 288.15, -6.5e-3},
                                              {11000, 216.65, 0},
                                              {20000, 216.65, 1e-3},
                                              {32000, 228.65, 2.8e-3},
                                              {47000, 270.65, 0},
                                              {51000, 270.65, -2.8e-3},
                                              {71000, 214.65, -2e-3},
                                              {84852, 186.946, 0}}};

/// H = r0 Z/(r0 + Z) and its inverse; both in metres.
constexpr double geopotential_m(double height_m) { return earth_radius_m * height_m / (earth_radius_m + height_m); }
constexpr double geometric_m(double geopotential) {
  return earth_radius_m * geopotential / (earth_radius_m - geopotential);
}

/// Molecular-scale temperature [K] and lapse [K/m of geometric height]. At a layer boundary: of the layer that starts
/// there. source: U.S. Standard Atmosphere, 1976 (NOAA-S/T 76-1562), tables 4 and equation 23.
Dual temperature_K(double height_m);

}  // namespace greenray::us76
