// Synthetic terrain for tests: places on the WGS84 ellipsoid, hills of known shape, and files of heights byte by byte.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "scene/height_field.hpp"
#include "support/angle.hpp"

namespace greenray::testing_terrain {

using Vector = std::array<double, 3>;

constexpr double wgs84_major_m = 6378137.0, wgs84_flattening = 1 / 298.257223563;

/// Earth-centred coordinates of a place on the ellipsoid [m].
inline Vector on_ellipsoid(const GeoPlace &p) {
  const double e2 = wgs84_flattening * (2 - wgs84_flattening);
  const double lat = to_rad(p.latitude_deg), lon = to_rad(p.longitude_deg);
  const double n = wgs84_major_m / std::sqrt(1 - e2 * std::sin(lat) * std::sin(lat));
  return {n * std::cos(lat) * std::cos(lon), n * std::cos(lat) * std::sin(lon), n * (1 - e2) * std::sin(lat)};
}

inline Vector minus(const Vector &a, const Vector &b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline double dot(const Vector &a, const Vector &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline double chord_m(const GeoPlace &a, const GeoPlace &b) {
  const Vector d = minus(on_ellipsoid(a), on_ellipsoid(b));
  return std::sqrt(dot(d, d));
}

/// Azimuth of a place from another, by the plane through the vertical: within 1e-8 rad of the geodesic's up to 50 km.
inline double azimuth_rad(const GeoPlace &from, const GeoPlace &to) {
  const double lat = to_rad(from.latitude_deg), lon = to_rad(from.longitude_deg);
  const Vector way = minus(on_ellipsoid(to), on_ellipsoid(from));
  const Vector east{-std::sin(lon), std::cos(lon), 0};
  const Vector north{-std::sin(lat) * std::cos(lon), -std::sin(lat) * std::sin(lon), std::cos(lat)};
  return std::atan2(dot(way, east), dot(way, north));
}

/// Along the surface, from the chord: the arc of a circle of the mean radius, within 1 mm up to 100 km.
inline double distance_m(const GeoPlace &a, const GeoPlace &b) {
  const double c = chord_m(a, b), r = 6371000;
  return 2 * r * std::asin(c / (2 * r));
}

/// A tile whose heights are a function of the place.
inline HeightTile tile_of(double south_deg, double west_deg, double spacing_deg, int rows, int columns,
                          const std::function<double(const GeoPlace &)> &height_m) {
  HeightTile tile;
  tile.name = "made", tile.south_deg = south_deg, tile.west_deg = west_deg;
  tile.row_deg = tile.column_deg = spacing_deg, tile.rows = rows, tile.columns = columns;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      tile.height_m.push_back(
          static_cast<float>(height_m({south_deg + spacing_deg * (rows - 1 - row), west_deg + spacing_deg * column})));
  return tile;
}

/// Bytes of an SRTM tile; big-endian.
inline std::string hgt_bytes(int side, const std::function<int(int row, int column)> &height_m) {
  std::string bytes;
  bytes.reserve(2 * static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      const int height = height_m(row, column);
      bytes += static_cast<char>((height >> 8) & 0xff);
      bytes += static_cast<char>(height & 0xff);
    }
  return bytes;
}

/// A GeoTIFF, tag by tag: little-endian, one uncompressed strip.
struct GeoTiffBytes {
  int rows = 3, columns = 4;
  std::vector<float> heights = {};       // of 32-bit floats, [rows][columns]
  std::vector<std::int16_t> whole = {};  // or of whole numbers
  std::vector<double> scale{0.5, 0.25, 0}, tiepoint{0, 0, 0, 10, 48, 0};
  int model = 2, raster = 1;  // geographic; pixel is area
  std::string no_data = {};
  int samples = 1;

  std::string bytes() const {
    std::string data;
    const std::string picture = heights.empty() ? raw(whole) : raw(heights);
    const std::vector<std::uint16_t> keys{1, 1, 0, 2, 1024, 0, 1, u16(model), 1025, 0, 1, u16(raster)};
    std::vector<Tag> tags{{256, 4, 1, u32(static_cast<std::uint32_t>(columns))},
                          {257, 4, 1, u32(static_cast<std::uint32_t>(rows))},
                          {258, 3, 1, u32(heights.empty() ? 16 : 32)},
                          {259, 3, 1, u32(1)},
                          {262, 3, 1, u32(1)},
                          {273, 4, 1, ""},
                          {277, 3, 1, u32(static_cast<std::uint32_t>(samples))},
                          {278, 4, 1, u32(static_cast<std::uint32_t>(rows))},
                          {279, 4, 1, u32(static_cast<std::uint32_t>(picture.size()))},
                          {339, 3, 1, u32(heights.empty() ? 2 : 3)},
                          {33550, 12, scale.size(), raw(scale)},
                          {33922, 12, tiepoint.size(), raw(tiepoint)},
                          {34735, 3, keys.size(), raw(keys)}};
    if (!no_data.empty()) tags.push_back({42113, 2, no_data.size() + 1, no_data + std::string(1, '\0')});
    const std::size_t after = 8 + 2 + 12 * tags.size() + 4;
    std::string directory = u16_text(static_cast<int>(tags.size()));
    for (Tag &tag : tags) {
      if (tag.number == 273) tag.value = u32(static_cast<std::uint32_t>(after));  // the picture comes first
      directory += u16_text(tag.number) + u16_text(tag.type) + u32(static_cast<std::uint32_t>(tag.count));
      if (tag.value.size() <= 4) {
        directory += tag.value + std::string(4 - tag.value.size(), '\0');
      } else {
        directory += u32(static_cast<std::uint32_t>(after + picture.size() + data.size()));
        data += tag.value + std::string(tag.value.size() % 2, '\0');
      }
    }
    return "II*" + std::string(1, '\0') + u32(8) + directory + u32(0) + picture + data;
  }

 private:
  struct Tag {
    int number, type;
    std::size_t count;
    std::string value;
  };
  static std::uint16_t u16(int value) { return static_cast<std::uint16_t>(value); }
  static std::string u16_text(int value) { return {static_cast<char>(value & 0xff), static_cast<char>(value >> 8)}; }
  static std::string u32(std::uint32_t value) {
    std::string text(4, '\0');
    std::memcpy(text.data(), &value, 4);
    return text;
  }
  template <class T>
  static std::string raw(const std::vector<T> &values) {
    std::string text(values.size() * sizeof(T), '\0');
    if (!values.empty()) std::memcpy(text.data(), values.data(), text.size());
    return text;
  }
};

}  // namespace greenray::testing_terrain
