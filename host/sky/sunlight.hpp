// Sunlight in the air: how much of it reaches a height, by the Sun's altitude there.
#pragma once
#include <array>
#include <vector>

#include "sky/air_shells.hpp"
#include "sky/axis.hpp"
#include "sky/optics.hpp"

namespace greenray {

/// The Sun's irradiance on a surface that faces it, over that outside the air: extinction on the bent way, the disk cut
/// by the Earth's bent horizon, and the spreading of bundles by refraction (differential refraction dims the low Sun).
/// The integral of the transmittance over all directions in which the disk is seen, images in mirages included; the
/// disk has a radius of its own and linear limb darkening of 0.6 for this. Wavelengths are bent like the shells' one.
class Sunlight {
 public:
  Sunlight(const AirShells &shells, const SkyOptics &optics, double sun_radius_rad);

  /// What to add up: share[w] = sum of weight[i] * row[i][w].
  struct Look {
    std::array<const float *, 4> row;
    std::array<float, 4> weight;
    double lift_rad;  // how much higher than its true altitude the Sun is seen there
    bool dark;        // all are 0
  };
  /// A height, found once for many looks.
  struct Height {
    Axis::Place level;
    double horizon_rad;
  };
  Height at_height(double height_m) const;
  /// altitude_rad: true, of the Sun's centre above the horizontal of that place.
  Look look(const Height &height, double altitude_rad) const;
  Look look(double height_m, double altitude_rad) const { return look(at_height(height_m), altitude_rad); }
  /// Fills share[w], w < padded.
  void share(double height_m, double altitude_rad, float *share) const;
  /// True altitude [rad] of the lowest ray that reaches a height.
  double horizon_rad(double height_m) const { return at_height(height_m).horizon_rad; }

 private:
  void fill_level(const AirShells &shells, const SkyOptics &optics, std::size_t row, std::size_t level);

  std::size_t padded_;
  double radius_rad_;
  Axis above_horizon_rad_;                  // u: altitudes counted from the horizon
  Axis height_m_;                           // levels
  std::vector<double> horizon_rad_, dip2_;  // by level; dip2: square of how far it lies below the ground's
  std::vector<float> share_;                // [levels][u][padded]
  std::vector<double> lift_rad_;            // [levels][u]
};

}  // namespace greenray
