// The Moon of a sky scene: the keys of [moon] with their defaults, units in the names. No behaviour.
#pragma once
#include <array>
#include <optional>

#include "atmosphere/profile_spec.hpp"

namespace greenray {

struct MoonScene {
  enum class Given { nothing, true_altitude, apparent_altitude } given = Given::nothing;
  double altitude_deg = 0.0;  // of its centre
  SourcePlace altitude_place;
  std::optional<double> azimuth_deg;  // default: the observer's
  double diameter_arcmin = 31.09;     // at 384400 km
  double phase_angle_deg = 0.0;       // between Sun and eye, seen from the Moon: 0 full, 180 new
  double bright_limb_deg = 0.0;       // where its Sun stands, from the top of the disk clockwise
  double sun_distance_au = 1.0;
  bool by_date = false;  // keys `when` and `place` gave all of these
  /// Axis of the Earth's shadow from the Moon's centre, to the right and up [arcmin]; none: no eclipse
  std::optional<std::array<double, 2>> shadow_arcmin;
};

}  // namespace greenray
