// Pixels over independent passes: mean, noise and bias, and a state that can be kept and taken up again.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace greenray {

/// Radius of pass 0, 1, 2 ... over that of pass 0: r_{i+1}^2 = r_i^2 (i + alpha)/(i + 1), i counted from 1.
/// source: Knaus & Zwicker, "Progressive photon mapping: a probabilistic approach", ACM TOG 30 (2011), eq 21
double pass_radius_ratio(int pass, double alpha = 2.0 / 3);

/// One pass over all pixels.
struct PassPixels {
  std::span<const float> radiance;  // [pixels][waves]
  std::span<const float> narrower;  // [pixels], summed over waves, from kernels of half the area
  std::span<const float> variance;  // [pixels], of that sum within this pass, as far as it is known
};

/// Sums in double, pixel by pixel, in the order of the passes: the same bits when a run is taken up again.
class PixelStatistics {
 public:
  PixelStatistics(std::size_t pixels, std::size_t waves);
  void add(const PassPixels &pass);
  /// Sums of later passes over the same pixels.
  void add(const PixelStatistics &later);
  /// Puts those of `part` in the place of pixels first, first + 1 ...; the passes too.
  void place(const PixelStatistics &part, std::size_t first);
  /// Of pixels first .. last - 1.
  PixelStatistics part(std::size_t first, std::size_t last) const;

  int passes() const { return passes_; }
  std::size_t pixels() const { return pixels_; }
  std::size_t waves() const { return waves_; }
  std::vector<float> mean() const;  // [pixels][waves]
  /// Standard error of the mean, of the sum over the waves: from pass to pass where there are enough of them (4), else
  /// from the variances within the passes.
  std::vector<float> noise() const;
  /// Estimated mean - truth, of the sum over the waves: a kernel of area A is off by a multiple of A, so twice the
  /// difference to a kernel of half the area. Of first order: it does not see what kernels of both sizes miss, as at
  /// the very edge of a surface.
  std::vector<float> bias() const;

  /// Relative to the mean of all pixels that `counts` (of each pixel; empty: all do).
  struct Totals {
    double noise_rms = 0;   // of a pixel's standard error
    double bias_rms = 0;    // of a pixel's bias, its own noise taken off; 0 where that hides it
    double bias_below = 0;  // with what noise may hide: two standard errors of that difference more
    double bias = 0;        // mean, with its sign
    double level_rms = 1;   // of the pixels themselves: light in few of them makes it large
    double error_rms() const;
    /// The same over the RMS of the picture, as `greenray compare` has it.
    double error_of_rms() const { return error_rms() / level_rms; }
    /// Whether the bias can be told from the noise.
    bool bias_is_seen() const { return bias_rms > 0; }
  };
  /* bias_rms: the noise of the difference d of the two kernels is known from pass to pass (from one pass alone: half of
     its variance, the share for this pair of Epanechnikov kernels and even photons), so that the mean of d^2 without
     it is that of the bias. It is a multiple of d: 2 where the irradiance is curved, 3.83 (RMS over all distances up to
     the radius) beside a straight step, be it a shadow or the edge of a surface. Rooms have both: their geometric
     mean, at most 1.4 off. bias_below: the standard error of that mean of squares from how it scatters between blocks
     of 8 x 8 pixels, whose kernels overlap little. columns: of the picture; 0: pixels do not hang together. */
  Totals totals(std::span<const unsigned char> counts = {}, std::size_t columns = 0) const;

  /// All there is, for a checkpoint: passes, then the sums.
  std::vector<double> state() const;
  std::size_t state_size() const { return 1 + radiance_.size() + 5 * pixels_; }
  /// Throws RunError when it is not the state of a picture of this size.
  void restore(std::span<const double> state);

 private:
  double noise2(std::size_t p, int enough) const;
  std::size_t pixels_, waves_;
  int passes_ = 0;
  std::vector<double> radiance_;  // [pixels][waves], sums
  // [pixels], of the sum over waves; differences: of kernels of the whole and of half the area, squared
  std::vector<double> sum_, squares_, narrower_, variance_, differences_;
  static const std::array<std::vector<double> PixelStatistics::*, 6> parts;  // in the order of the state
};

}  // namespace greenray
