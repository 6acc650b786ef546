// What air, ozone and haze do to light, wavelength by wavelength.
#pragma once
#include <vector>

#include "sky/air_shells.hpp"

namespace greenray {

/// Spectral arrays are padded to whole groups of this many floats, so that loops over them need no remainder.
inline constexpr std::size_t spectral_group = 8;

/// Coefficients of one wavelength each; the padding repeats the last one.
struct SkyOptics {
  std::vector<double> wavelength_nm;                  // unpadded
  std::vector<float> rayleigh_per_kg_m2;              // optical depth per column of air
  std::vector<float> ozone_per_m;                     // optical depth per metre at the ozone layer's peak
  std::vector<float> aerosol_per_m;                   // extinction at the surface
  std::vector<float> rayleigh_even, rayleigh_square;  // phase function: even + square cos^2 [1/sr]
  double aerosol_albedo = 1;                          // of single scattering
  double aerosol_asymmetry = 0;                       // Henyey & Greenstein's g
  std::size_t waves() const { return wavelength_nm.size(); }
  std::size_t padded() const { return rayleigh_per_kg_m2.size(); }
};

/// gamma of Rayleigh's phase function from the King factors of N2, O2, Ar and CO2 (Bates 1984), mixed as in Bodhaine et
/// al. 1999, eqs 5, 6 and 23.
double rayleigh_anisotropy(double wavelength_nm);

/// Rayleigh's phase function, 1/sr, mean 1/(4 pi): 3/(16 pi) ((1 + 3 gamma) + (1 - gamma) cos^2)/(1 + 2 gamma)
/// (Chandrasekhar; Bucholtz 1995, eq 12). = even + square cos^2 of the scattering angle.
struct RayleighPhase {
  double even, square;
};
RayleighPhase rayleigh_phase(double anisotropy);

/// Henyey & Greenstein 1941, 1/sr.
double aerosol_phase(double cosine, double asymmetry);

/// Fills depth[w] of a path, w < padded.
void optical_depths(const SkyOptics &optics, const Columns &columns, float *depth);

}  // namespace greenray
