// A sky picture as it fills: radiance, its variance, and what the rays of the pixels' centres did.
#pragma once
#include "compute/sky_shader.hpp"
#include "render/renderer.hpp"
#include "render/targets.hpp"
#include "render/transfer.hpp"

namespace greenray {

/// Rows first, first + 1 ... of the crop, as a file keeps them.
struct SkyRows {
  int first = 0;
  std::vector<int> samples;              // of each row
  std::vector<float> radiance, moments;  // [rows][width][waves]; [rows][width][2]: of the samples' sums
};

class SkyPicture {
 public:
  explicit SkyPicture(const RenderPlan &plan);
  int width() const { return image_.width; }
  int height() const { return image_.height; }

  /// Rows first_row .. first_row + rows - 1 of the crop from the sums over `samples` samples of each pixel.
  void keep(const SkySums &sums, int first_row, int rows, int samples);
  /// Channels bending_arcsec, distance_m, min_height_m of the pixels' centres at the middle wavelength.
  void describe(const f32::SkyView &view, const TransferTable &table);
  /// Channels target_distance_m, target_height_m: of the nearest target that covers at least half of the pixel's centre
  /// at the middle wavelength, and of the ray above the surface there; 0 where there is none.
  void describe_targets(const f32::SkyView &view, const TargetTable &targets, const StationSights &sights);
  /// The same channels where terrain is nearer.
  void describe_terrain(const f32::SkyView &view, const TerrainTable &terrain);
  SkyRows rows(int first, int last) const;
  /// returns: false, with nothing changed, when they are rows of another picture
  bool set_rows(const SkyRows &rows);
  int most_samples() const;
  const SpectralImage &image() const { return image_; }
  /// RMS over pixels of the spectral mean's standard error, over the picture's mean.
  double noise_rms() const;
  SpectralImage take() { return std::move(image_); }

 private:
  std::size_t waves_;
  std::array<int, 4> crop_;
  SpectralImage image_;
  std::vector<int> samples_;    // of each row; 0: not kept yet
  std::vector<float> moments_;  // [pixels][2]
};

/// The same measure as SkyPicture::noise_rms for one band.
double relative_noise(const SkySums &sums, int samples);

}  // namespace greenray
