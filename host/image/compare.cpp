#include "image/compare.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "image/exr.hpp"
#include "support/error.hpp"

namespace greenray {

static std::string size_text(const RgbImage &image) {
  return std::to_string(image.width) + "x" + std::to_string(image.height);
}

static double channel_difference(double a, double b) {
  const double difference = std::abs(a - b);
  if (std::isfinite(difference)) return difference;
  const bool same = a == b || (std::isnan(a) && std::isnan(b));
  return same ? 0.0 : std::numeric_limits<double>::infinity();
}

ImageDifference compare_images(const RgbImage &image, const RgbImage &reference, const std::filesystem::path &name) {
  if (image.width != reference.width || image.height != reference.height)
    throw InputError(SourcePlace{name.string(), 1, 1}, "expected a picture of " + size_text(reference) +
                                                           " pixels like the reference, found " + size_text(image));
  constexpr double infinite = std::numeric_limits<double>::infinity();
  double squares = 0, reference_squares = 0, peak = 0;
  ImageDifference result;
  result.pixels = image.pixels();
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    const auto b = static_cast<double>(reference.rgb[i]);
    const double difference = channel_difference(static_cast<double>(image.rgb[i]), b);
    result.max_abs = std::max(result.max_abs, difference);
    squares += difference * difference;
    if (std::isfinite(b)) {
      reference_squares += b * b;
      peak = std::max(peak, std::abs(b));
    }
  }
  const double samples = std::max<double>(1.0, static_cast<double>(image.rgb.size()));
  result.rms = std::sqrt(squares / samples);
  const double reference_rms = std::sqrt(reference_squares / samples);
  if (result.rms > 0) result.relative_rms = reference_rms > 0 ? result.rms / reference_rms : infinite;
  result.psnr_db = result.rms > 0 ? 20 * std::log10(peak / result.rms) : infinite;
  return result;
}

ImageDifference compare_exr(const std::filesystem::path &image, const std::filesystem::path &reference) {
  return compare_images(read_exr(image).rgb(), read_exr(reference).rgb(), image);
}

}  // namespace greenray
