#include "scene/height_tile.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace greenray {
namespace {

namespace fs = std::filesystem;

constexpr int void_height = -32768;
constexpr float lowest_m = -500, highest_m = 9000;  // shores of the Dead Sea; Mount Everest

/// A whole number of exactly `digits` digits at `at`, or -1.
int number_at(const std::string &text, std::size_t at, std::size_t digits) {
  if (text.size() < at + digits) return -1;
  int number = 0;
  for (std::size_t i = at; i < at + digits; ++i) {
    if (!std::isdigit(static_cast<unsigned char>(text[i]))) return -1;
    number = 10 * number + (text[i] - '0');
  }
  return number;
}

/// South-western corner by the name: N46E007*.hgt.
bool corner_of_name(const std::string &name, HeightTile &tile) {
  const int latitude = number_at(name, 1, 2), longitude = number_at(name, 4, 3);
  if (latitude < 0 || longitude < 0 || latitude > 90 || longitude > 180) return false;
  const char north = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  const char east = static_cast<char>(std::toupper(static_cast<unsigned char>(name[3])));
  if ((north != 'N' && north != 'S') || (east != 'E' && east != 'W')) return false;
  if (name.size() < 8 || std::isalnum(static_cast<unsigned char>(name[7]))) return false;
  tile.south_deg = north == 'N' ? latitude : -latitude;
  tile.west_deg = east == 'E' ? longitude : -longitude;
  return true;
}

}  // namespace

std::uint64_t fingerprint_of(const void *bytes, std::size_t count) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (std::size_t i = 0; i < count; ++i) {
    hash ^= static_cast<const unsigned char *>(bytes)[i];
    hash *= 0x100000001b3u;
  }
  return hash;
}

void require_earthly(const HeightTile &tile, const std::string &path, const SourcePlace &asked_at) {
  for (const float height : tile.height_m)
    if (height < lowest_m || height > highest_m)
      throw InputError(asked_at, "'" + path + "': expected heights from -500 to 9000 m, found " +
                                     std::to_string(std::lround(height)) + " (wrong byte order, or not metres?)");
}

HeightTile read_hgt(const std::string &path, const SourcePlace &asked_at) {
  HeightTile tile;
  tile.name = fs::path(path).filename().string();
  if (!corner_of_name(tile.name, tile))
    throw InputError(asked_at, "'" + path +
                                   "': expected a name that begins with the tile's south-western corner, "
                                   "such as N46E007.hgt");
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) throw InputError(asked_at, "no such terrain file: '" + path + "'");
  const std::uintmax_t size = fs::file_size(path, ignored);
  for (const int side : {1201, 3601})
    if (size == 2u * static_cast<std::uintmax_t>(side) * static_cast<std::uintmax_t>(side)) tile.rows = side;
  if (tile.rows == 0)
    throw InputError(asked_at, "'" + path +
                                   "': expected 2884802 bytes (1201 x 1201 heights) or 25934402 (3601 x 3601), "
                                   "found " +
                                   std::to_string(size) + " (cut short, or packed?)");
  tile.columns = tile.rows;
  tile.row_deg = tile.column_deg = 1.0 / (tile.rows - 1);
  std::vector<unsigned char> bytes(size);
  std::ifstream file(path, std::ios::binary);
  if (!file.read(reinterpret_cast<char *>(bytes.data()), static_cast<std::streamsize>(size)))
    throw InputError(asked_at, "'" + path + "': cannot be read");
  tile.fingerprint = fingerprint_of(bytes.data(), bytes.size());
  tile.height_m.resize(size / 2);
  for (std::size_t i = 0; i < tile.height_m.size(); ++i) {
    const auto height = static_cast<std::int16_t>(bytes[2 * i] << 8 | bytes[2 * i + 1]);
    tile.height_m[i] = height == void_height ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(height);
  }
  require_earthly(tile, path, asked_at);
  return tile;
}

HeightTile read_height_tile(const std::string &path, const SourcePlace &asked_at) {
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".hgt") return read_hgt(path, asked_at);
  if (extension == ".tif" || extension == ".tiff") return read_geotiff(path, asked_at);
  if (extension == ".asc") return read_ascii_grid(path, asked_at);
  throw InputError(asked_at,
                   "'" + path + "': expected terrain that ends in .hgt (SRTM), .tif (GeoTIFF) or .asc (ASCII grid)");
}

}  // namespace greenray
