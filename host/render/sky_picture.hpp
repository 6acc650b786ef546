// A sky picture as it fills: radiance, its variance, and what the rays of the pixels' centres did.
#pragma once
#include "compute/sky_shader.hpp"
#include "render/renderer.hpp"
#include "render/targets.hpp"
#include "render/transfer.hpp"

namespace greenray {

class SkyPicture {
 public:
  explicit SkyPicture(const RenderPlan &plan);
  int width() const { return image_.width; }
  int height() const { return image_.height; }

  /// Rows first_row .. first_row + rows - 1 of the crop from the sums over `samples` samples of each pixel. Keep each
  /// row once, in order: the noise is summed in that order.
  void keep(const SkySums &sums, int first_row, int rows, int samples);
  /// Channels bending_arcsec, distance_m, min_height_m of the pixels' centres at the middle wavelength.
  void describe(const f32::SkyView &view, const TransferTable &table);
  /// Channels target_distance_m, target_height_m: of the nearest target that covers at least half of the pixel's centre
  /// at the middle wavelength, and of the ray above the surface there; 0 where there is none.
  void describe_targets(const f32::SkyView &view, const TargetTable &targets, const StationSights &sights);
  /// RMS over pixels of the spectral mean's standard error, over the picture's mean.
  double noise_rms() const;
  SpectralImage take() { return std::move(image_); }

 private:
  std::size_t waves_;
  std::array<int, 4> crop_;
  SpectralImage image_;
  double variance_sum_ = 0, band_sum_ = 0;
};

/// The same measure as SkyPicture::noise_rms for one band.
double relative_noise(const SkySums &sums, int samples);

}  // namespace greenray
