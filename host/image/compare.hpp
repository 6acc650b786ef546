// How far two pictures are apart (`greenray compare`).
#pragma once
#include <cstddef>
#include <filesystem>

#include "image/spectral_image.hpp"

namespace greenray {

struct ImageDifference {
  double rms = 0;           // over R, G, B of all pixels, in the units of the pictures (cd/m2)
  double max_abs = 0;       // largest difference of one channel
  double relative_rms = 0;  // rms / rms of the reference; 0 for two black pictures
  double psnr_db = 0;       // 20 log10(largest channel of the reference / rms); +infinity for equal pictures
  std::size_t pixels = 0;
};

/* Difference of `image` to `reference`.
   A value that is not finite on one side only, or of another kind, makes rms and max_abs infinite: it never passes.
   errors: different sizes -> InputError naming both (`name`, line 1) */
ImageDifference compare_images(const RgbImage &image, const RgbImage &reference,
                               const std::filesystem::path &name = "picture");

/// The same for R, G, B (cd/m2) of the first part of two EXR files.
ImageDifference compare_exr(const std::filesystem::path &image, const std::filesystem::path &reference);

}  // namespace greenray
