#include "vision/tone_curve.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "vision/threshold.hpp"

namespace greenray::vision {

namespace {

constexpr std::size_t bins = BrightnessHistogram::bins;
constexpr double tiny = 1e-6;              // of brightness: pcond's
constexpr double tolerated_share = 0.025;  // of the samples may exceed the ceiling
constexpr double shoulder_share = 0.8;     // of Ldmax: where a linear map begins to bend

/// Lower end that leaves one bin below the darkest sample, or the darkest that counts.
double low_end(double high, double darkest) {
  const double least = std::log(darkest_cd_m2);
  if (darkest < least) return least;
  return high - (high - darkest) * static_cast<double>(bins) / static_cast<double>(bins - 1);
}

class HistogramBuilder {
 public:
  HistogramBuilder(double low, double high) { histogram_.low = low, histogram_.high = high; }
  void add(double brightness, double weight) {
    BrightnessHistogram &h = histogram_;
    if (!(brightness >= h.low + tiny && brightness < h.high - tiny)) return;
    const auto bin = static_cast<std::size_t>(static_cast<double>(bins) * (brightness - h.low) / (h.high - h.low));
    h.count[std::min(bin, bins - 1)] += weight;
    h.total += weight;
    h.mean += weight * brightness;
  }
  BrightnessHistogram finish() {
    BrightnessHistogram &h = histogram_;
    if (h.total > 0) h.mean /= h.total;
    if (h.low > std::log(darkest_cd_m2) + tiny) {
      h.count[1] *= 0.5;
      h.count[0] += h.count[1];
    }
    return h;
  }

 private:
  BrightnessHistogram histogram_;
};

void check_table(const std::vector<double> &level, const std::vector<double> &count) {
  if (level.size() < 2 || level.size() != count.size()) throw std::domain_error("expected two rows or more");
  const double step = level[1] - level[0];
  if (!(step > tiny)) throw std::domain_error("expected log10 luminances that ascend");
  for (std::size_t i = 1; i < level.size(); ++i)
    if (!(std::abs(level[i] - level[i - 1] - step) <= 0.001))
      throw std::domain_error("expected log10 luminances in even steps, found another step at row " +
                              std::to_string(i + 1));
  for (const double value : count)
    if (!(value >= 0) || std::isinf(value)) throw std::domain_error("expected counts that are finite and 0 or more");
  if (!std::any_of(count.begin(), count.end(), [](double c) { return c > tiny; }))
    throw std::domain_error("expected a count above 0");
}

}  // namespace

double BrightnessHistogram::percentile_cd_m2(double share) const {
  double left = share * total;
  std::size_t bin = 0;
  while (bin + 1 < bins && (left -= count[bin]) > 0) ++bin;
  return std::exp(low + (static_cast<double>(bin) + 0.5) * (high - low) / static_cast<double>(bins));
}

BrightnessHistogram histogram_from_table(const std::vector<double> &log10_cd_m2, const std::vector<double> &count) {
  check_table(log10_cd_m2, count);
  const double start = std::numbers::ln10 * log10_cd_m2[0];
  const double step = std::numbers::ln10 * (log10_cd_m2[1] - log10_cd_m2[0]);
  const auto counted = [](double c) { return c > tiny; };
  const auto first = std::find_if(count.begin(), count.end(), counted) - count.begin();
  const auto last = count.rend() - std::find_if(count.rbegin(), count.rend(), counted) - 1;
  const double high = std::min(start + (static_cast<double>(last) + 1.001) * step, std::log(brightest_cd_m2));
  const double darkest = start + (static_cast<double>(first) - 0.001) * step;
  if (!(high > darkest) || high <= std::log(darkest_cd_m2))
    throw std::domain_error("expected luminances between 1e-7 and 1e10 cd/m2");
  HistogramBuilder builder(low_end(high, darkest), high);
  double brightness = start;
  for (const double weight : count) {
    builder.add(brightness, weight);
    brightness += step;
  }
  const BrightnessHistogram histogram = builder.finish();
  if (histogram.dark()) throw std::domain_error("expected luminances between 1e-7 and 1e10 cd/m2");
  return histogram;
}

BrightnessHistogram histogram_from_samples(const std::vector<float> &foveal_cd_m2, const std::vector<float> &weight,
                                           const std::vector<float> &points_cd_m2) {
  double least = brightest_cd_m2, most = 0;
  for (const std::vector<float> *samples : {&foveal_cd_m2, &points_cd_m2})
    for (const float value : *samples)
      least = std::min(least, static_cast<double>(value)), most = std::max(most, static_cast<double>(value));
  if (!(most > darkest_cd_m2)) return {};
  const double high = std::log(std::min(most * 1.01, brightest_cd_m2));
  const double low = least < darkest_cd_m2 ? std::log(darkest_cd_m2) : low_end(high, std::log(least));
  HistogramBuilder builder(std::min(low, high - 0.01), high);
  double foveal_weight = 0;
  for (std::size_t i = 0; i < foveal_cd_m2.size(); ++i) {
    builder.add(std::log(static_cast<double>(foveal_cd_m2[i])), static_cast<double>(weight[i]));
    foveal_weight += static_cast<double>(weight[i]);
  }
  const double each = foveal_weight > 0 ? foveal_weight / static_cast<double>(points_cd_m2.size()) : 1.0;
  for (const float value : points_cd_m2) builder.add(std::log(static_cast<double>(value)), each);
  return builder.finish();
}

ToneCurve::ToneCurve(const BrightnessHistogram &histogram, const Display &display, bool sensitivity)
    : display_(display),
      low_(histogram.low),
      high_(histogram.high),
      display_low_(std::log(display.min_cd_m2())),
      display_high_(std::log(display.max_cd_m2)) {
  if (!(display.max_cd_m2 > 0) || !(display.contrast > 1) || std::isinf(display.max_cd_m2) ||
      std::isinf(display.contrast))
    throw std::domain_error("expected a display with Ldmax above 0 and a contrast above 1");
  linear_ = histogram.dark() || high_ - low_ <= display_high_ - display_low_ || !adjust(histogram, sensitivity);
  if (!linear_ || histogram.dark()) return;
  const double middle_cd_m2 = std::exp(0.5 * (display_low_ + display_high_)), world_cd_m2 = std::exp(histogram.mean);
  scale_ = sensitivity ? luminance_threshold_cd_m2(middle_cd_m2) / luminance_threshold_cd_m2(world_cd_m2)
                       : middle_cd_m2 / world_cd_m2;
}

/// Shares below each bin edge.
void ToneCurve::accumulate(const std::array<double, bins> &count, double total) {
  double sum = 0;
  for (std::size_t i = 0; i < bins; ++i) {
    cumulative_[i] = sum / total;
    sum += count[i];
  }
  cumulative_[bins] = 1;
}

/* Trims the bins to the ceiling until few samples stand above it.
   returns: false when nearly all was trimmed away: no map keeps below the ceiling */
bool ToneCurve::adjust(const BrightnessHistogram &histogram, bool sensitivity) {
  std::array<double, bins> count = histogram.count;
  const double width = (high_ - low_) / static_cast<double>(bins);
  const double display_range = display_high_ - display_low_;
  for (double trimmed = 0, total = 0;; ++passes_) {
    total = std::accumulate(count.begin(), count.end(), 0.0);
    if (!(total > tolerated_share * histogram.total)) return false;
    accumulate(count, total);
    trimmed = 0;
    for (std::size_t i = 0; i < bins; ++i) {
      const double b = low_ + (static_cast<double>(i) + 0.5) * width;
      const double world = std::exp(b), shown = std::exp(brightness(b));
      const double contrast_ratio =
          sensitivity ? luminance_threshold_cd_m2(shown) / luminance_threshold_cd_m2(world) : shown / world;
      const double ceiling = total * width * contrast_ratio * world / (shown * display_range);
      if (count[i] > ceiling) trimmed += count[i] - ceiling, count[i] = ceiling;
    }
    if (!(trimmed > tolerated_share * total)) return true;
  }
}

double ToneCurve::brightness(double world_brightness) const {
  if (!(world_brightness > low_ + tiny)) return display_low_;
  if (world_brightness >= high_ - tiny) return display_high_;
  const double position = static_cast<double>(bins) * (world_brightness - low_) / (high_ - low_);
  const std::size_t bin = std::min(static_cast<std::size_t>(position), bins - 1);
  const double t = position - static_cast<double>(bin);
  const double rise = t * (cumulative_[bin + 1] - cumulative_[bin]);
  const double share = std::min(cumulative_[bin] + rise, cumulative_[bin + 1]);  // rounding must not make it fall
  return display_low_ + share * (display_high_ - display_low_);
}

double ToneCurve::display_cd_m2(double world_cd_m2) const {
  if (linear_) return std::clamp(scale_ * world_cd_m2, display_.min_cd_m2(), display_.max_cd_m2);
  return std::exp(brightness(std::log(world_cd_m2)));
}

double ToneCurve::display_fraction(double world_cd_m2) const {
  if (!(world_cd_m2 >= darkest_cd_m2)) return 0;
  double shown = 0;
  if (linear_) {
    shown = scale_ * std::min(world_cd_m2, brightest_cd_m2);
    const double knee = shoulder_share * display_.max_cd_m2, room = display_.max_cd_m2 - knee;
    if (shown > knee) shown = knee + room * (shown - knee) / (room + shown - knee);
  } else {
    shown = std::exp(brightness(std::log(world_cd_m2)));
  }
  return std::clamp((shown - display_.min_cd_m2()) / (display_.max_cd_m2 - display_.min_cd_m2()), 0.0, 1.0);
}

std::vector<std::pair<double, double>> ToneCurve::table() const {
  std::vector<std::pair<double, double>> rows;
  for (std::size_t i = 0; i < bins; ++i) {
    const double world = std::exp(low_ + (static_cast<double>(i) + 0.5) * (high_ - low_) / static_cast<double>(bins));
    rows.emplace_back(world, display_cd_m2(world));
  }
  return rows;
}

}  // namespace greenray::vision
