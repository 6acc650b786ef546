// Rows of a picture as light on the eye: colour, luminance, and light for the rods, cleaned of what is no light.
#pragma once
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "image/picture_source.hpp"

namespace greenray::vision {

/// Pixels that were no light, and what became of them.
struct LightFaults {
  std::uint64_t not_a_number =
      0;  // NaN or -infinite: the nearest valid pixel of the row, the left one first; black if there is none
  std::uint64_t infinite = 0;    // white with the largest finite luminance of the picture
  std::uint64_t negative = 0;    // luminance below 0: black
  std::uint64_t too_bright = 0;  // beyond 1e10 cd/m2: scaled down to that
  std::uint64_t total() const { return not_a_number + infinite + negative + too_bright; }
  void add(const LightFaults &other);
};

/* Turns the planes of a source into light planes [plane][row][x], in cd/m2:
   0..2 colour X, Y, Z: CIE 2015 (2 degrees) for spectra; what the file says otherwise
   3    photopic luminance (CIE 1931), only for spectra; else it is plane 1
   4    scotopic luminance, only for spectra; else it follows from the colour */
class LightConverter {
 public:
  explicit LightConverter(const PictureFacts &facts);
  std::size_t planes() const { return spectral_ ? 5 : 3; }
  std::size_t luminance_plane() const { return spectral_ ? 3 : 1; }
  /// infinite_becomes_cd_m2: see LightFaults. light: resized. raw: [planes of the source][count], used up.
  LightFaults convert(std::vector<float> &raw, std::size_t width, std::size_t rows, float infinite_becomes_cd_m2,
                      std::vector<float> &light) const;

 private:
  LightFaults clean(std::size_t width, std::size_t rows, float infinite_becomes_cd_m2, std::vector<float> &light) const;
  bool spectral_;
  std::vector<std::vector<float>> weights_;  // [plane][wavelength]
};

/// Light planes to scene-linear Rec. 709 [count][3], cd/m2. planes: 3 or 5 as above.
std::vector<float> linear_rgb(const std::vector<float> &light, std::size_t count);

/* The light of a whole picture, by rows: kept in memory where it fits in the budget, else read and converted anew. */
class LightStore {
 public:
  LightStore(PictureSource &source, std::size_t budget_bytes);
  const LightConverter &converter() const { return converter_; }
  bool in_memory() const { return kept_ != nullptr; }
  void set_infinite(float cd_m2) { infinite_becomes_cd_m2_ = cd_m2; }
  /// Reads rows from the source; keeps them if there is room. Threads may load different rows at once.
  LightFaults load(int first, int rows, std::vector<float> &light);
  /// A row of one plane. Only while in_memory().
  const float *row(std::size_t plane, int y) const {
    return kept_.get() + width_ * (plane * height_ + static_cast<std::size_t>(y));
  }

 private:
  PictureSource &source_;
  LightConverter converter_;
  std::size_t width_, height_;
  float infinite_becomes_cd_m2_ = 0;
  std::unique_ptr<float[]> kept_;  // [plane][height][width], not set before load()
};

}  // namespace greenray::vision
