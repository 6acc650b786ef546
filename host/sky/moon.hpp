// The Moon's own light: how bright its disk is, by wavelength and phase.
#pragma once

namespace greenray {

/* Lommel and Seeliger's law over the disk, 2 mu0/(mu0 + mu), which the dark Moon follows closely (full, it is as bright
   at the limb as in the middle), scaled so that the whole disk follows Allen's phase law (1973, Astrophysical
   Quantities): fainter by 0.026 a + 4e-9 a^4 magnitudes at a degrees from full. The opposition surge below 5 degrees,
   seas and craters are not in it. */

/// Geometric albedo: 0.12 at 550 nm, redder as Lane & Irvine 1973 found (slope 0.19 % a nm).
double lunar_albedo(double wavelength_nm);

/// Disk-integrated phase function of Lommel & Seeliger's law, 1 at full.
double lommel_seeliger_phase(double phase_rad);

/// Radiance factor of the disk: radiance = it x irradiance of the Sun / pi x albedo x 2 mu0/(mu0 + mu).
double lunar_phase_factor(double phase_rad);

}  // namespace greenray
