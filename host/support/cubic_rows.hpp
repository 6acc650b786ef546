// Values between the rows of an evenly spaced table.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace greenray {

/// Value at `position` (in rows) of the cubic through the four rows around it; near an end, the four nearest.
inline double cubic_between_rows(const std::vector<double> &rows, double position) {
  const double last_start = static_cast<double>(rows.size()) - 4.0;
  const double start = std::clamp(std::floor(position) - 1.0, 0.0, last_start);
  const double t = position - start;
  double value = 0;
  for (int i = 0; i < 4; ++i) {
    double weight = 1;
    for (int j = 0; j < 4; ++j)
      if (j != i) weight *= (t - j) / (i - j);
    value += weight * rows[static_cast<std::size_t>(start) + static_cast<std::size_t>(i)];
  }
  return value;
}

}  // namespace greenray
