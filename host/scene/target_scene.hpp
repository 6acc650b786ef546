// What stands before the sky in a picture: [[target]] rows of a scene, units in the names. No behaviour.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "support/error.hpp"

namespace greenray {

/// Upright, at a distance along the surface, facing the eye: part of the cylinder about it. Across: metres to the right
/// of its middle; up: metres above the surface.
struct TargetScene {
  enum class Kind { rectangle, triangle, polygon, billboard } kind = Kind::rectangle;
  double distance_m = 0;
  std::optional<double> azimuth_deg;  // of its middle; default: the observer's
  double offset_m = 0;                // and so far to the right of that
  double base_m = 0;                  // its lower edge; of a polygon: what is added to its corners
  double width_m = 0, height_m = 0;
  std::vector<std::array<double, 2>> outline_m;  // polygon: corners [across, up]
  std::string picture;                           // billboard: a .png or .exr
  std::array<double, 3> colour{1, 1, 1};         // reflectance, or colour of what shines; times the picture
  std::optional<double> luminance_cd_m2;         // shines by itself: of white; without it: lit by Sun and sky
  SourcePlace place;
};

}  // namespace greenray
