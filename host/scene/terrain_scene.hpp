// Terrain of a sky scene: the keys of [terrain], units in the names. No behaviour.
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "scene/height_field.hpp"

namespace greenray {

struct TerrainScene {
  std::shared_ptr<const HeightField> field;  // null: no terrain
  GeoPlace eye;                              // observer.place
  double ground_m = 0;                       // terrain under the eye
  double farthest_m = 100e3;
  bool missing_is_sea = false;
  std::array<double, 3> reflectance{0.2, 0.2, 0.2};
  SourcePlace place;
};

}  // namespace greenray
