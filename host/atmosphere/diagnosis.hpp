// What a profile does to light: ray curvature, ducts, inversions, layers that bend upwards, and the mirages to expect.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "atmosphere/profile.hpp"

namespace greenray {

/// Light of this wavelength decides about ducts and mirages.
inline constexpr double diagnosis_wavelength_nm = 550.0;
/// Ray curvature over the Earth's in the US Standard Atmosphere at sea level; more is looming, less is sinking.
inline constexpr double standard_ray_curvature = 0.17;

/* Heights between which light can be held. Rays curve more than the surface inside the trapping layer; the duct
   reaches from its top down to where the modified index M is the same as at that top, or to the ground. */
struct Duct {
  double bottom_m = 0;            // of the whole duct; 0 when it stands on the ground
  double trapping_bottom_m = 0;   // M has a maximum here,
  double top_m = 0;               // a minimum here: top of the trapping layer and of the duct
  double index_drop = 0;          // fall of M across the trapping layer, about the fall in n beyond 1/R
  double widest_trapped_deg = 0;  // steepest ray held, where it crosses trapping_bottom_m
};

/// Temperature rises with height.
struct Inversion {
  double bottom_m = 0, top_m = 0;
  double rise_K = 0;             // T(top) - T(bottom)
  double steepest_K_m = 0;       // largest dT/dh sampled inside
  double largest_curvature = 0;  // largest k inside; 1 and more traps
};

/// Refractivity (in dry air: density) rises with height, so rays bend upwards; in air dT/dh < -0.0342 K/m.
struct SuperadiabaticLayer {
  double bottom_m = 0, top_m = 0;
  double fall_K = 0;      // T(bottom) - T(top); 0 for a medium given by its index
  double index_rise = 0;  // ln n(top) - ln n(bottom)
};

struct Diagnosis {
  double curvature_at_ground = 0;  // k at h = 0
  std::vector<Duct> ducts;         // each list ascending in height
  std::vector<Inversion> inversions;
  std::vector<SuperadiabaticLayer> superadiabatic;
  std::vector<std::string> expect;  // one sentence for each thing to see
};

/* k(h) = -(R + h) d(ln n)/dh at 550 nm: curvature of a level ray over that of the level surface there.
   height_m: 0 and up;  returns: 1 follows the surface, 0 is straight, below 0 bends upwards
   errors:   below the ground -> std::domain_error
   source:   curvature of a level ray is -d(ln n)/dh (Bouguer) */
double ray_curvature(const Profile &profile, double height_m);

/// M(h) = ln n + ln(1 + h/R): a ray of elevation e keeps M + ln cos e, so light is held between heights of larger M.
double modified_index(const Profile &profile, double height_m);

/* Looks at the whole profile, with 1e-7 of a height to the edges it reports.
   eye_height_m: the sentences of `expect` are then about this eye; without one they are about the air alone
   errors: impossible air -> InputError, as in Profile */
Diagnosis diagnose(const Profile &profile, std::optional<double> eye_height_m = std::nullopt);

/// A number for a sentence: `significant` digits, never an exponent ("0.1286", "12000").
std::string plain_number(double value, int significant = 3);

/// An angle for a sentence, in the unit that fits its size: deg, arc-minutes or arc-seconds.
std::string plain_angle(double angle_rad);

}  // namespace greenray
