// Rows of a picture as the eye sees them: resolved, bleached, mixed of cones and rods, toned, brought into gamut.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "vision/adaptation.hpp"
#include "vision/human_eye.hpp"
#include "vision/pigment.hpp"
#include "vision/retinal_light.hpp"

namespace greenray::vision {

/// What bands of rows add up to.
struct BandSums {
  std::uint64_t gamut_moved = 0;
  std::array<double, 3> least_unbleached{1, 1, 1};
  GreenerSums greener;
  void add(const BandSums &other);
};

/// Display-linear rows [rows][width][3]; overlay and map as compare_rows() has them, empty unless wanted.
struct SeenBand {
  std::vector<float> rgb, overlay, map;
  BandSums sums;
};

class RowObserver {
 public:
  /// All arguments are kept by reference. pigment: its pixels are used where it keeps them.
  RowObserver(const EyeOptions &options, PictureSource &source, const RetinalLight &light, const Adaptation &adaptation,
              const Retina &retina, PigmentHistory &pigment);

  /// Rows first .. last-1, first a multiple of a cell. Safe to call from several threads for different rows.
  SeenBand see(int first, int last);

  /// `shape` of a picture without spectra: each colour is taken as a sum of bands.
  bool assumes_spectra() const { return band_screening_.has_value(); }

 private:
  /// A row in work, one array for each quantity.
  struct Row {
    explicit Row(std::size_t width);
    std::vector<float> colour[3], luminance, scotopic, unbleached[3], before[3], luminance_before;
    std::vector<SelfScreening> screening;
    RowLevels levels;
  };

  std::size_t used_planes() const;
  void resolve(std::vector<Pyramid::Band> &light, int y, Row &row) const;
  void bleach(int y, const float *spectra, std::size_t spacing, Row &row, BandSums &sums);
  void screen(const float *spectra, std::size_t spacing, Row &row) const;
  void compare(const float *with, Row &row, float *overlay, float *map, BandSums &sums) const;

  const EyeOptions &options_;
  PictureSource &source_;
  const RetinalLight &light_;
  const Adaptation &adaptation_;
  const Retina &retina_;
  PigmentHistory &pigment_;
  std::size_t width_, channels_;
  std::vector<Pyramid> pyramids_;  // [light plane]
  std::optional<SpectralScreening> spectral_screening_;
  std::optional<BandScreening> band_screening_;
};

}  // namespace greenray::vision
