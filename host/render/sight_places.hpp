// Where the rays of one eye are at given distances along the surface, by the method asked for.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "atmosphere/air_section.hpp"
#include "render/sky_rays.hpp"

namespace greenray {

/// A line of sight where it passes a distance; one that ended before (ground, space) goes on straight from there, so
/// that its height is a continuous function of its elevation.
struct SightPlace {
  int outcome = 0;  // in flight, or what ended it before
  double height_m = 0, bending_rad = 0;
  std::array<double, 3> column{};  // up to there, or to its end: air [kg/m^2], ozone and aerosol [m]
  int turning_points = 0;          // before there; through a duct without end two at least
};

class SightPlaces {
 public:
  /// options as of SkyRays; section: through air that varies along the surface, or as if it did.
  SightPlaces(const AirSection &air, const std::vector<double> &wavelengths_nm, const SkyRayOptions &options,
              bool section, std::shared_ptr<Device> device);
  ~SightPlaces();

  /// [elevations][wavelengths][distances]. azimuths_rad: of each elevation, from where the eye looks, in air that
  /// varies along the surface; empty: all 0.
  std::vector<SightPlace> at(std::span<const double> elevations_rad, std::span<const double> distances_m,
                             std::span<const double> azimuths_rad = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace greenray
