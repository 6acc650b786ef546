// Which pixels bleaching makes greener, and by how much (G04 figure 6.2, right).
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace greenray::vision {

/// A pixel is greener when its colour moved by more than 1 unit of CIEDE2000, its CIELAB hue toward unique green (164
/// deg), and its new hue is a green one: beyond yellow (100 to 230 deg).
struct GreenerStats {
  std::uint64_t pixels = 0;        // that are greener
  double hue_shift_deg = 0;        // mean over them
  double delta_e2000 = 0;          // mean over them
  double largest_delta_e2000 = 0;  // of all pixels
  std::uint64_t changed = 0;       // pixels that moved by more than 1 unit in any direction
};

/// Sums over rows, joined in any order.
struct GreenerSums {
  std::uint64_t pixels = 0, changed = 0;
  double hue_shift_deg = 0, delta_e2000 = 0, largest = 0;
  void add(const GreenerSums &other);
  GreenerStats stats() const;
};

/* Compares display-linear colours [count][3] seen without and with bleaching.
   overlay: [count][3] display-linear: the picture in grey, greener pixels green, the stronger the larger the difference
   map: [count][2]: hue shift [deg], CIEDE2000; 0 where the colour did not change */
GreenerSums compare_rows(std::size_t count, const float *without, const float *with, float *overlay, float *map);

}  // namespace greenray::vision
