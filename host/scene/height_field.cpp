#include "scene/height_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "support/angle.hpp"

namespace greenray {
namespace {

constexpr double metres_per_deg = 111195;  // of a meridian, 6371 km

/// Node and way to the next one.
struct Between {
  int node;
  float way;
};
Between between(double place, int count) {
  const int node = std::clamp(static_cast<int>(place), 0, count - 2);
  return {node, static_cast<float>(place - node)};
}

/// Rise to the north or east at a node [m per node], one-sided at the tile's edge and beside voids.
float difference(const HeightTile &t, int row, int column, int rows_on, int columns_on) {
  const auto at = [&](int side) {
    const int r = std::clamp(row + side * rows_on, 0, t.rows - 1);
    const int c = std::clamp(column + side * columns_on, 0, t.columns - 1);
    const float height = t.at(r, c);
    return std::isnan(height) ? std::pair{0, t.at(row, column)}
                              : std::pair{std::abs(r - row) + std::abs(c - column), height};
  };
  const auto [before, low] = at(-1);
  const auto [after, high] = at(1);
  return before + after > 0 ? (high - low) / static_cast<float>(before + after) : 0;
}

}  // namespace

HeightField::HeightField(std::vector<HeightTile> tiles) : tiles_(std::move(tiles)) {}

const HeightTile *HeightField::find(const GeoPlace &place, double &longitude_deg, std::size_t &hint) const {
  constexpr double rounding_deg = 1e-9;
  for (std::size_t k = 0; k < tiles_.size(); ++k) {
    const std::size_t i = (hint + k) % tiles_.size();
    const HeightTile &t = tiles_[i];
    if (place.latitude_deg < t.south_deg - rounding_deg || place.latitude_deg > t.north_deg() + rounding_deg) continue;
    for (const double turn : {0.0, 360.0, -360.0}) {
      longitude_deg = place.longitude_deg + turn;
      if (longitude_deg < t.west_deg - rounding_deg || longitude_deg > t.east_deg() + rounding_deg) continue;
      hint = i;
      return &t;
    }
  }
  return nullptr;
}

HeightField::Cover HeightField::height(const GeoPlace &place, float &into, std::size_t &hint) const {
  double longitude = 0;
  const HeightTile *t = find(place, longitude, hint);
  if (!t) return Cover::none;
  const Between y = between((t->north_deg() - place.latitude_deg) / t->row_deg, t->rows);
  const Between x = between((longitude - t->west_deg) / t->column_deg, t->columns);
  const float a = t->at(y.node, x.node), b = t->at(y.node, x.node + 1);
  const float c = t->at(y.node + 1, x.node), d = t->at(y.node + 1, x.node + 1);
  const float upper = a + x.way * (b - a), lower = c + x.way * (d - c), height = upper + y.way * (lower - upper);
  if (std::isnan(height)) return Cover::void_;
  into = height;
  return Cover::land;
}

HeightField::Cover HeightField::relief(const GeoPlace &place, Relief &into, std::size_t &hint) const {
  const Cover cover = height(place, into.height_m, hint);
  if (cover != Cover::land) return cover;
  const HeightTile &t = tiles_[hint];
  double longitude = 0;
  find(place, longitude, hint);
  const Between y = between((t.north_deg() - place.latitude_deg) / t.row_deg, t.rows);
  const Between x = between((longitude - t.west_deg) / t.column_deg, t.columns);
  float east = 0, north = 0;
  for (int k = 0; k < 4; ++k) {
    const int row = y.node + (k >> 1), column = x.node + (k & 1);
    const float weight = (k & 1 ? x.way : 1 - x.way) * (k >> 1 ? y.way : 1 - y.way);
    if (weight == 0) continue;
    east += weight * difference(t, row, column, 0, 1);
    north -= weight * difference(t, row, column, 1, 0);
  }
  const double north_m = metres_per_deg * t.row_deg;
  const double east_m = metres_per_deg * t.column_deg * std::max(std::cos(to_rad(place.latitude_deg)), 1e-6);
  into.slope_east = east / static_cast<float>(east_m), into.slope_north = north / static_cast<float>(north_m);
  return Cover::land;
}

double HeightField::spacing_m() const {
  double least = 1e9;
  for (const HeightTile &t : tiles_) least = std::min(least, t.row_deg * metres_per_deg);
  return least;
}

std::string degree_square(const GeoPlace &place) {
  const int south = static_cast<int>(std::floor(place.latitude_deg));
  const int west = static_cast<int>(std::floor(std::remainder(place.longitude_deg, 360)));
  char text[32];
  std::snprintf(text, sizeof text, "%c%02d%c%03d", south < 0 ? 'S' : 'N', std::abs(south), west < 0 ? 'W' : 'E',
                std::abs(west));
  return text;
}

}  // namespace greenray
