// Pictures in memory. Rows run from the top of the picture, pixels from the left.
#pragma once
#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace greenray {

/// Spectral radiance of a picture, with named scalar channels beside it ("true_altitude_deg", "variance").
struct SpectralImage {
  int width = 0, height = 0;
  std::vector<double> wavelength_nm;  // ascending
  std::vector<float> radiance;        // [height][width][wavelengths], wavelength fastest, W m^-2 sr^-1 nm^-1
  std::map<std::string, std::vector<float>> channels;  // each [height][width]

  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

/// Linear Rec. 709 / D65; (1,1,1) has a luminance of 1 cd/m2 (scene) or is display white (display-linear).
struct RgbImage {
  int width = 0, height = 0;
  std::vector<float> rgb;  // [height][width][3]

  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  std::array<double, 3> pixel(std::size_t i) const { return {rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]}; }
  void set_pixel(std::size_t i, const std::array<double, 3> &value) {
    for (std::size_t c = 0; c < 3; ++c) rgb[3 * i + c] = static_cast<float>(value[c]);
  }
};

}  // namespace greenray
