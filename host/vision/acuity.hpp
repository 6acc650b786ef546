// How fine a detail the eye resolves, and mesopic vision: colours and brightness between cones and rods.
#pragma once

namespace greenray::vision {

/* Visual acuity [cycles/degree] of an eye adapted to adaptation_cd_m2; 2.7 in the dark to 49 in daylight (limit 52.8).
   source: Shaler 1937, as fitted in Ward Larson et al. 1997: 17.25 atan(1.4 log10 La + 0.35) + 25.72 */
double acuity_cycles_deg(double adaptation_cd_m2);

/* Share of colour (cones) against grey (rods): 0 below 0.00562, 1 above 5.62 cd/m2, straight between.
   source: Ward Larson et al. 1997, section on colour sensitivity */
double cone_share(double luminance_cd_m2);
inline constexpr double top_of_mesopic_cd_m2 = 5.62;
inline constexpr double scotopic_per_photopic_white = 2.26;  // of equal-energy white: a grey of it keeps its luminance

/// Scotopic luminance of an XYZ colour [cd/m2], >= 0; source: Larson, Y (1.33 (1 + (Y+Z)/X) - 1.68), 0 without X.
double scotopic_from_xyz(double x, double y, double z);

struct Mesopic {
  double luminance_cd_m2;
  double cone_share;  // m: 1 above 5, 0 below 0.005 cd/m2
};
/* Luminance as the CIE's recommended mesopic system measures it.
   source: CIE 191:2010: Lmes = (m Lp + (1-m) Ls C)/(m + (1-m) C), C = 683/1699; m = 0.7670 + 0.3334 log10 Lmes in 0..1,
           iterated from m = 0.5 */
Mesopic cie191(double photopic_cd_m2, double scotopic_cd_m2);

}  // namespace greenray::vision
