// One file of terrain heights: an evenly spaced grid in latitude and longitude.
#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "support/error.hpp"

namespace greenray {

/// Heights above the sea at nodes of a grid; void ones are NaN.
struct HeightTile {
  std::string name;
  double south_deg = 0, west_deg = 0;  // of the node in the last row, first column
  double row_deg = 0, column_deg = 0;  // spacing, both positive
  int rows = 0, columns = 0;
  std::vector<float> height_m;    // [rows][columns], from north to south, west to east
  std::uint64_t fingerprint = 0;  // of the file

  double north_deg() const { return south_deg + row_deg * (rows - 1); }
  double east_deg() const { return west_deg + column_deg * (columns - 1); }
  float at(int row, int column) const {
    return height_m[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                    static_cast<std::size_t>(column)];
  }
};

/* A tile of the Shuttle Radar Topography Mission: a degree square of 1201 x 1201 or 3601 x 3601 heights, big-endian
   16-bit whole metres, -32768 where there is none, named after its south-western corner (N46E007.hgt, S34W071.hgt; more
   may follow before .hgt).
   errors: InputError at `asked_at`: no such file, another name or size, heights that no place on Earth has
   source: Farr et al., Rev. Geophys. 45 (2007) RG2004; SRTM documentation, USGS */
HeightTile read_hgt(const std::string &path, const SourcePlace &asked_at);

/* An elevation model as a GeoTIFF in geographic coordinates (ModelTiepoint and ModelPixelScale, OGC 19-008r4), one
   band of whole numbers or floats, metres.
   errors: InputError at `asked_at`: not such a file, another projection or unit; always, where greenray was built
   without libtiff */
HeightTile read_geotiff(const std::string &path, const SourcePlace &asked_at);

/* A grid of heights as text (Arc/Info ASCII grid): ncols, nrows, xllcorner and yllcorner (or xllcenter, yllcenter),
   cellsize in degrees, NODATA_value (-9999), then rows of heights from the north. A file, or one that ships.
   errors: InputError at its line and column; at `asked_at` where there is no such file */
HeightTile read_ascii_grid(const std::string &path, const SourcePlace &asked_at);

/// By its extension: .hgt, .tif, .tiff, .asc.
HeightTile read_height_tile(const std::string &path, const SourcePlace &asked_at);

/// Complains about heights that no place on Earth has: wrong byte order, or another unit.
void require_earthly(const HeightTile &tile, const std::string &path, const SourcePlace &asked_at);

/// FNV-1a, 64 bits.
std::uint64_t fingerprint_of(const void *bytes, std::size_t count);

}  // namespace greenray
