// Refractivity n-1 of air at any state, by four index models, and its derivative by height.
#pragma once
#include "atmosphere/dual.hpp"
#include "atmosphere/profile_spec.hpp"

namespace greenray {

/// The state of air at one height, each with its derivative by height.
struct AirState {
  Dual temperature_K;
  Dual pressure_Pa;  // total
  Dual vapour_Pa;    // partial pressure of water vapour
};

/// Refractivity of the model's own reference air (dry; 0 C or 15 C, 101325 Pa). wavelength_nm in vacuum, 200..2000.
double reference_refractivity(IndexModel model, double wavelength_nm);

/// n-1 of air. Gladstone-Dale (G04 4.3): n-1 = (rho/rho_ref)(n_ref - 1), rho_ref the density of the constants' own air.
/// born_wolf: G04 4.2 with B = 5.67e-3 um^2 (G04 prints 5.67e-5 without unit). iag1999: closed form of IAG resolution 3
/// (1999) with its vapour term. peck_reeder: J. Opt. Soc. Am. 62 (1972) 958, eq 2. ciddor: Appl. Opt. 35 (1996) 1566,
/// 450 ppm CO2, with compressibility; the only one besides iag1999 in which vapour matters.
Dual refractivity(IndexModel model, double wavelength_nm, const AirState &air);

/// Saturation vapour pressure over water [Pa] (Ciddor 1996 after Davis 1992) times the enhancement factor of moist air.
Dual saturation_vapour_Pa(Dual temperature_K, Dual pressure_Pa);

}  // namespace greenray
