// What the three kinds of cone and the rods catch of a light, unbleached or bleached, and what colour that is.
#pragma once
#include <array>
#include <optional>
#include <vector>

namespace greenray::vision {

using Lms = std::array<double, 3>;  // L, M, S

/// A light, straight between its samples and zero outside them.
struct Spectrum {
  std::vector<double> wavelength_nm;  // strictly ascending, two at least
  std::vector<double> radiance;       // W m^-2 sr^-1 nm^-1, or relative where only its shape counts; same length
};

/// Strictly ascending wavelengths, finite radiances >= 0, some light in the visible -> else std::domain_error.
void check_spectrum(const Spectrum &light);

/// Luminance [cd/m2] by the CIE 1931 function, and scotopic luminance by the CIE 1951 one (1700.06 lm/W).
double luminance_cd_m2(const Spectrum &light);
double scotopic_luminance_cd_m2(const Spectrum &light);

/// Scotopic luminance [cd/m2] per radiance of each sample of a light that is straight between its samples.
std::vector<double> scotopic_weights(const std::vector<double> &wavelength_nm);
inline constexpr double scotopic_per_photopic_d65 = 2.47;  // of daylight

/* Sensitivity of a cone (0 L, 1 M, 2 S) to energy at a wavelength, 2 degrees, age 32, with the given fraction of its
   pigment left: (1 - 10^(-D u A)) 10^(-macula - lens) x wavelength_nm. Self-screening: as u falls the curve narrows.
   returns: zero outside 390 to 780 nm
   source: Stockman & Sharpe 2000 = CIE 170-1:2006: peak densities 0.38 + 0.54 exp(-2/1.333) (L, M), 0.30 + 0.45
           exp(-2/1.333) (S), macula 0.485 exp(-2/6.132); tables at 5 nm, cubic between rows */
double cone_sensitivity(std::size_t cone, double wavelength_nm, double unbleached = 1);

/// Integral of light x sensitivity.
Lms cone_catches(const Spectrum &light, const Lms &unbleached = {1, 1, 1});

/* Retinal illuminance that each kind of cone is exposed to: trolands of a 560 nm light that would bleach it as fast.
   td: photopic trolands of the light. Bleaching constants were measured at 560 nm with L and M cones 2 : 1, so
   T_i = I [int S c_i / int S V] / [(2 c_L(560) + c_M(560)) / (3 V(560))]. A red light bleaches L cones most. */
Lms cone_trolands(const Spectrum &light, double td);

/* The same constants for lights given by their cone responses: T_i = I factor_i LMS_i / Y, where LMS_i belongs to
   fundamentals of peak 1 and Y to the luminance of the same light in the same units. */
const Lms &cone_troland_factors();

/* Stockman & Sharpe fundamentals of peak 1 [cd/m2 scale of XYZ] and CIE 2015 (2 degrees) colour matching.
   source: CIE 170-2:2015 */
std::array<double, 3> xyz_from_lms(const Lms &lms);
Lms lms_from_xyz(const std::array<double, 3> &xyz);

/* Wavelength of the single-wavelength light with the same ratio of L to M response: how red or green it looks.
   response: L, M by cone_catches (any common factor)
   returns: nothing where no wavelength from 475 to 690 nm has that ratio */
std::optional<double> equivalent_wavelength_nm(const Lms &response);

/// The same for responses scaled to fundamentals of peak 1 (lms_from_xyz).
std::optional<double> equivalent_wavelength_of_peak_one(const Lms &lms);

}  // namespace greenray::vision
