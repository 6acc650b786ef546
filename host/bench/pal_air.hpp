// The air inside palRefro, as a medium that our methods can trace: so that both do the same job.
#pragma once
#include "atmosphere/index_table.hpp"

namespace greenray::bench {

/// What palRefro is told about the site. Dry air, so relative humidity is 0.
struct PalSite {
  double eye_m = 2, temperature_K = 288.15, pressure_hPa = 1013.25, wavelength_um = 0.55;
  double latitude_rad = 0.7853981633974483, lapse_K_m = 0.0065;
};

/* The two layers that palRefro knows: temperature falls evenly to 11 km, refractivity exponentially from there to 80
   km, where it ends; hydrostatic, on a sphere of 6378.12 km, index by IAG 1999. The wavelength of the site, whatever is
   asked.
   source: Hohenkerk & Sinclair, NAO Technical Note 63 (1985), and the notes of palRefro in PAL 0.9; for dry air the
           refractivity of a polytrope is a power of T, (n - 1) = (n_eye - 1) (T/T_eye)^(g M/(R lapse) - 1). */
LayeredMedium pal_air(const PalSite &site = {});

}  // namespace greenray::bench
