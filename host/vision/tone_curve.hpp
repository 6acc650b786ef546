// Histogram adjustment: from luminances of a scene to luminances of a display, after Ward Larson, Rushmeier and Piatko
// 1997.
#pragma once
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace greenray::vision {

inline constexpr double darkest_cd_m2 = 1e-7;    // shown as black below
inline constexpr double brightest_cd_m2 = 1e10;  // pcond stops at 1e7, which cuts the Sun

struct Display {
  double max_cd_m2 = 100;  // Ldmax
  double contrast = 100;   // Ldmax / Ldmin, > 1
  double min_cd_m2() const { return max_cd_m2 / contrast; }
};

/// Counts of brightness B = ln(luminance in cd/m2) in 100 even bins.
struct BrightnessHistogram {
  static constexpr std::size_t bins = 100;
  double low = 0, high = 0;          // of B; high > low unless there is no light at all
  std::array<double, bins> count{};  // the bottom bin holds half of its neighbour: room for what is darker
  double total = 0;                  // of all counts
  double mean = 0;                   // of B
  bool dark() const { return !(total > 0); }
  /// Luminance that this share of the counts does not exceed, to a bin.
  double percentile_cd_m2(double share) const;
};

/* From a table, as `pcond -I` reads it.
   log10_cd_m2: ascending in even steps (to 0.001), two rows at least; count: >= 0, not all 0
   errors: std::domain_error with what was expected */
BrightnessHistogram histogram_from_table(const std::vector<double> &log10_cd_m2, const std::vector<double> &count);

/* From samples of a picture: foveal averages (each weighted) and single points, which together weigh as much.
   Luminances that are not above darkest_cd_m2 widen the range but are not counted.
   No light at all gives a histogram that is dark(). */
BrightnessHistogram histogram_from_samples(const std::vector<float> &foveal_cd_m2, const std::vector<float> &weight,
                                           const std::vector<float> &points_cd_m2);

/* The map of one histogram to one display.
   sensitivity: the ceiling is what an eye can tell apart (human contrast sensitivity); else contrast is just not raised
   source: Ward Larson et al. 1997 sections 4.2-4.6, constants as in Radiance's pcond of December 2021
   differs: world luminance to 1e10 instead of 1e7; where the method gives up, or all fits the display, the map is
   linear as in pcond, but pixels (display_fraction) get a soft shoulder instead of overflowing */
class ToneCurve {
 public:
  ToneCurve(const BrightnessHistogram &histogram, const Display &display, bool sensitivity);

  bool is_linear() const { return linear_; }
  double linear_scale() const { return scale_; }  // display per world luminance, where linear
  int passes() const { return passes_; }          // of trimming

  /// Display luminance [cd/m2], within [Ldmin, Ldmax] and never falling.
  double display_cd_m2(double world_cd_m2) const;
  /// What a pixel shows, 0 (Ldmin) to 1 (Ldmax), never falling; 0 for darkness and NaN.
  double display_fraction(double world_cd_m2) const;
  /// World and display luminance at the middle of each bin.
  std::vector<std::pair<double, double>> table() const;

 private:
  bool adjust(const BrightnessHistogram &histogram, bool sensitivity);
  void accumulate(const std::array<double, BrightnessHistogram::bins> &count, double total);
  double brightness(double world_brightness) const;

  Display display_;
  double low_, high_, display_low_, display_high_;
  std::array<double, BrightnessHistogram::bins + 1> cumulative_{};
  bool linear_ = false;
  double scale_ = 0;
  int passes_ = 0;
};

}  // namespace greenray::vision
