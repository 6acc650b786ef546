// Many pictures at a glance: thumbnails in rows.
#pragma once
#include <filesystem>
#include <vector>

#include "image/png.hpp"

namespace greenray {

/* PNG files from left to right and top to bottom, each made smaller by box averages of light (not of sRGB values) to
   fit a cell of the first one's shape; a sheet is at most `width` pixels wide. Pictures are read one at a time. errors:
   no pictures -> std::invalid_argument; missing or damaged ones -> InputError */
Raster contact_sheet(const std::vector<std::filesystem::path> &pictures, int width = 1600);

/// A picture made smaller by box averages of light, no wider than that; 8 bits.
Raster shrunk(const Raster &picture, int widest_pixels);

}  // namespace greenray
