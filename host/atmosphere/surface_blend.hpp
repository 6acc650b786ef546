// What balloons cannot see: the air between the surface and the first rows, from two thermometers.
#pragma once
#include <optional>

#include "atmosphere/profile_spec.hpp"

namespace greenray {

struct SurfaceBlend {
  double water_K = 0;           // of the surface itself
  std::optional<double> air_K;  // of the air away from it, at top_m and below; none: as the profile has it
  double top_m = 0;             // where the surface is no longer felt
};

/* Adds T = T_atm + delta_T exp(-h/scale) with delta_T = water - T_atm(0) and scale = top/ln 100, so that a hundredth of
   delta_T is left at top_m. With air_K the profile below top_m first becomes air at that temperature: rows up to twice
   top_m give way to one at 0 and one at top_m, from which T runs straight to the next row (with base = "us76" and no
   rows, the standard atmosphere above is shifted to join). Relative humidity and the surface pressure stay. Inversions
   and layers the profile already has stay too; the new rows are corrected for them, so that the air has air_K at 0 and
   at top_m before the surface warms or cools it.
   errors: a medium given by its index, top_m outside 0..10 km, temperatures outside 100..2000 K -> InputError at
   `place` Each change is told in spec.notes. */
void blend_surface(ProfileSpec &spec, const SurfaceBlend &blend, const SourcePlace &place);

}  // namespace greenray
