// Terrain: tiles of heights side by side.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/geodesic.hpp"
#include "scene/height_tile.hpp"

namespace greenray {

/// Terrain at a place.
struct Relief {
  float height_m = 0;
  float slope_east = 0, slope_north = 0;  // rise over run
};

class HeightField {
 public:
  explicit HeightField(std::vector<HeightTile> tiles);

  enum class Cover { land, none, void_ };
  /* Heights are bilinear between nodes, slopes bilinear between central differences at nodes.
     hint: index of the tile that was found last, kept by the caller
     returns: whether there is data; `into` is left alone where there is none */
  Cover relief(const GeoPlace &place, Relief &into, std::size_t &hint) const;
  Cover height(const GeoPlace &place, float &into, std::size_t &hint) const;

  /// Closest spacing of nodes along a meridian [m].
  double spacing_m() const;
  const std::vector<HeightTile> &tiles() const { return tiles_; }

 private:
  const HeightTile *find(const GeoPlace &place, double &longitude_deg, std::size_t &hint) const;
  std::vector<HeightTile> tiles_;
};

/// "N46E007": the degree square of a place, as SRTM names it.
std::string degree_square(const GeoPlace &place);

}  // namespace greenray
