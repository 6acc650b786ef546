// Light that air and ground have scattered before: what fills the shadows, and the sky after the Sun has set.
#pragma once
#include <array>
#include <vector>

#include "sky/sunlight.hpp"

namespace greenray {

/* All orders of scattering after the first, and the ground's light, in spherical air by successive orders: of the light
   that arrives at a place only its mean over directions J and its flux H are kept (P1), by height and the Sun's
   altitude there; a line of sight gathers from it J for air and J + 3 g H.v for the aerosol. Single scattering, with
   its exact phase functions, starts the sequence. Orders beyond the fourth are a geometric series. Lines of sight are
   those of `AirShells`, coarse ones. Differs from Hillaire 2020 (one bounce more, then the same sunlight everywhere):
   each order has its own field over the whole Earth, which twilight needs, and haze scatters forward. */
class DiffuseLight {
 public:
  DiffuseLight(const LayeredMedium &medium, double wavelength_nm, const LayerAbsorbers &absorbers,
               const SkyOptics &optics, const Sunlight &sunlight, double ground_albedo);

  /// What to add up, for light of irradiance 1 outside the air: mean[w] = sum weight[i] row[i][w], flux up and sunward
  /// in the next two rows of `padded`.
  struct Look {
    std::array<const float *, 4> row;
    std::array<float, 4> weight;
  };
  /// A height, found once for many looks.
  struct Height {
    Axis::Place level;
    double horizon_rad;  // of the bare sphere
  };
  Height at_height(double height_m) const;
  Look look(const Height &height, double altitude_rad) const;
  /// Irradiance on the level ground by the sky, [padded], over that of the Sun outside the air.
  void irradiance(double altitude_rad, float *irradiance) const;
  std::size_t padded() const { return padded_; }
  /// Each order's part of the mean light, averaged over the field: the last one tells how the series converges.
  const std::vector<double> &orders() const { return orders_; }

 private:
  struct Line;
  struct Orders;
  std::size_t index(std::size_t level, std::size_t sun) const { return (level * sun_rad_.size() + sun) * 3 * padded_; }
  void add_tail(const std::vector<float> &last, const std::vector<float> &before, std::vector<float> &sum) const;

  std::size_t padded_;
  Axis height_m_, sun_rad_;
  double radius_m_;
  std::vector<double> scale_;      // by which light falls with the Sun's altitude, about; [levels][sun]
  std::vector<float> field_;       // [levels][sun][mean, up, sunward][padded]
  std::vector<float> irradiance_;  // [sun][padded]
  std::vector<double> orders_;
};

}  // namespace greenray
