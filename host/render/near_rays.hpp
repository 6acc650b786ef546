// Rays of one eye to places above the surface: height and direction after given distances, many calls, one table.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "atmosphere/air_section.hpp"
#include "render/sky_rays.hpp"

namespace greenray {

/// One ray at one distance.
struct NearRay {
  int outcome = 0;  // RAY_IN_FLIGHT there, or what ended it before
  double distance_m = 0, height_m = 0, altitude_rad = 0, bending_rad = 0;  // there, or where it ended
};

class NearRays {
 public:
  /// Double where the device has it. section: steps through air that varies along the surface, towards azimuth_rad.
  NearRays(const AirSection &air, double height_m, double wavelength_nm, bool flat, bool section, double azimuth_rad,
           std::shared_ptr<Device> device);
  ~NearRays();

  /// [elevations][distances]; elevations [rad] above the eye's horizontal, distances [m] along the surface, ascending
  /// (of air that varies, where a ray ended is told from the distance before, along the mean of its directions).
  std::vector<NearRay> trace(std::span<const double> elevations_rad, std::span<const double> distances_m);
  double height_m() const;
  double earth_radius_m() const;
  bool flat() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace greenray
