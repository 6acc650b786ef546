// Finished pixels, and the PNG files that carry them.
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "image/spectral_image.hpp"
#include "support/atomic_file.hpp"

namespace greenray {

/// sRGB-encoded pixels of 8 or 16 bits.
struct Raster {
  int width = 0, height = 0;
  int bits = 8;                    // 8 or 16
  std::vector<std::uint16_t> rgb;  // [height][width][3], 0 .. 2^bits - 1
};

/* Display-linear colours (1 = display white; outside 0..1 is clipped, NaN is 0) through the sRGB curve into whole
   numbers. dither: triangular noise of at most +-1 step with a fixed seed, so that smooth skies do not band; it narrows
           towards 0 and full scale, which stay exact. The same picture gives the same bits. */
Raster quantise(const RgbImage &display_linear, int bits = 8, bool dither = true);

/* The same for `count` samples of a row, the first being sample first_sample of the whole picture: pieces of a picture
   get the noise that the whole would. */
void quantise_samples(const float *display_linear, std::size_t count, std::size_t first_sample, int bits, bool dither,
                      std::uint16_t *levels);

/// PNG with sRGB, gAMA and cHRM chunks. errors: RunError.
std::vector<char> encode_png(const Raster &raster);
void write_png(AtomicFile &file, const Raster &raster);
void write_png(const std::filesystem::path &path, const Raster &raster);

/// Any PNG, as 8 or 16 bit RGB. alpha: levels of what each pixel covers are added to it, full where the file has none;
/// null: left out. errors: missing or damaged -> InputError `file:1:1: ...`
Raster read_png(const std::filesystem::path &path, std::vector<std::uint16_t> *alpha = nullptr);

}  // namespace greenray
