// Bleaching and regeneration of a photopigment by first-order kinetics, solved exactly.
#pragma once

namespace greenray::vision {

/// du/dt = (1 - u)/tau - I u/(I0 tau), u the unbleached fraction.
struct Pigment {
  double half_bleach_td = 2.0e4;  // I0: steady light that bleaches half
  double time_constant_s = 120;   // tau: of regeneration in the dark
};

/// Rushton & Henry 1968 (560 nm); what G04 6.2 uses. Its "6.1 log td" for 20 000 td is log td s: I0 tau = 2.4e6 td s.
inline constexpr Pigment rushton_henry{2.0e4, 120};
/// Rods, Wyszecki & Stiles 1982: scotopic trolands.
inline constexpr Pigment rod_pigment{30250, 519};

/// Unbleached fraction under steady light: I0/(I0 + I). td: retinal illuminance of this pigment, >= 0.
double steady_unbleached(double td, const Pigment &pigment = rushton_henry);

/* Unbleached fraction after `seconds` of steady light from the fraction `before`.
   Exact: u_inf + (u_0 - u_inf) exp(-t (1 + I/I0)/tau); a history of steps of light is exact too, step after step.
   source: Rushton & Henry, Vision Research 8, 617 (1968); G04 6.2-bleaching */
double unbleached_after(double before, double td, double seconds, const Pigment &pigment = rushton_henry);

/// Time until half is bleached, from none; infinity where steady light leaves more than half.
double half_bleach_seconds(double td, const Pigment &pigment = rushton_henry);

}  // namespace greenray::vision
