// Which wavelengths a picture is made of, and what Sun and air do at each.
#pragma once
#include <vector>

#include "atmosphere/profile_spec.hpp"
#include "scene/scene.hpp"

namespace greenray {

/// `samples` wavelengths [nm], ascending, from range[0] to range[1], evenly spaced in refractivity: dispersion spreads
/// the Sun's images in equal steps, so wavelengths crowd in the blue. One sample: the middle of the range.
std::vector<double> wavelengths_even_in_refraction(IndexModel model, const std::array<double, 2> &range_nm,
                                                   int samples);

/// What light meets at one wavelength.
struct SpectralAir {
  double sun_centre_radiance;  // outside the air, centre of the disk [W m^-2 sr^-1 nm^-1]
  std::array<double, 6> limb;  // I(mu)/I(1) = sum limb[k] mu^k
  double rayleigh_per_kg_m2;   // optical depth per column of air [m^2/kg]
  double ozone_per_m;          // optical depth per metre of path at the ozone layer's peak
  double aerosol_per_m;        // extinction at the surface [1/m]

  /// Mean radiance of the disk over that of its centre: 2 integral of I(mu) mu dmu.
  double limb_mean() const;
  /// Irradiance outside the air by a disk of this radius, on a surface that faces it [W m^-2 nm^-1].
  double irradiance_outside(double radius_rad) const;
};

/// Spectrum: ASTM E-490 (2000). Limb darkening: Neckel & Labs 1994. Rayleigh: Bodhaine et al. 1999. Ozone:
/// Serdyuchenko, Gorshelev et al. 2011-14, 233 K. Aerosol: Angstrom's law through the visibility (Koschmieder, 2 %
/// contrast) or the turbidity. Throws nothing: tables are embedded; outside 360..830 nm the scene is refused before.
std::vector<SpectralAir> spectral_air(const Scene &scene, const std::vector<double> &wavelength_nm);

/// The ozone layer: a Gaussian in height.
inline constexpr double ozone_peak_m = 22000, ozone_width_m = 5000;
inline constexpr double mean_sun_radius_arcsec = 959.63;

}  // namespace greenray
