#include "vision/greener.hpp"

#include <algorithm>
#include <cmath>

#include "image/colour.hpp"
#include "vision/colour_difference.hpp"

namespace greenray::vision {

namespace {

constexpr double unique_green_deg = 164, first_green_deg = 100, last_green_deg = 230;

struct Difference {
  double hue_shift_deg, delta_e2000;
  bool greener;
};

Lab lab_of(const float *rgb) {
  return lab_from_xyz(
      xyz_from_rgb({static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])}));
}

Difference compare(const float *without, const float *with) {
  const Lab before = lab_of(without), after = lab_of(with);
  const double h0 = hue_deg(before), h1 = hue_deg(after);
  const double away_before = std::abs(hue_shift_deg(h0, unique_green_deg));
  const double away_after = std::abs(hue_shift_deg(h1, unique_green_deg));
  const double difference = ciede2000(before, after);
  const bool green = h1 >= first_green_deg && h1 <= last_green_deg;
  return {hue_shift_deg(h0, h1), difference, difference > 1 && away_after < away_before && green};
}

}  // namespace

void GreenerSums::add(const GreenerSums &other) {
  pixels += other.pixels;
  changed += other.changed;
  hue_shift_deg += other.hue_shift_deg;
  delta_e2000 += other.delta_e2000;
  largest = std::max(largest, other.largest);
}

GreenerStats GreenerSums::stats() const {
  const double n = static_cast<double>(std::max<std::uint64_t>(pixels, 1));
  return {pixels, hue_shift_deg / n, delta_e2000 / n, largest, changed};
}

GreenerSums compare_rows(std::size_t count, const float *without, const float *with, float *overlay, float *map) {
  GreenerSums sums;
  for (std::size_t i = 0; i < count; ++i) {
    const float *before = without + 3 * i, *after = with + 3 * i;
    Difference d{0, 0, false};
    if (before[0] != after[0] || before[1] != after[1] || before[2] != after[2]) d = compare(before, after);
    sums.changed += d.delta_e2000 > 1 ? 1 : 0;
    sums.largest = std::max(sums.largest, d.delta_e2000);
    if (d.greener) {
      ++sums.pixels;
      sums.hue_shift_deg += d.hue_shift_deg;
      sums.delta_e2000 += d.delta_e2000;
    }
    const auto grey = static_cast<float>(
        0.5 * luminance({static_cast<double>(after[0]), static_cast<double>(after[1]), static_cast<double>(after[2])}));
    const float strength = d.greener ? static_cast<float>(std::min(1.0, 0.35 + d.delta_e2000 / 20)) : 0.0F;
    for (std::size_t c = 0; c < 3; ++c)
      overlay[3 * i + c] = c == 1 ? std::max(grey, strength) : d.greener ? 0.0F : grey;
    map[2 * i] = static_cast<float>(d.hue_shift_deg);
    map[2 * i + 1] = static_cast<float>(d.delta_e2000);
  }
  return sums;
}

}  // namespace greenray::vision
