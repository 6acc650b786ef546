#include <algorithm>
#include <cmath>

#include "compute/photon_map.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

/// Largest power of two that is not above n.
int power_of_two_below(double n) { return 1 << std::clamp(static_cast<int>(std::log2(std::max(n, 1.0))), 0, 30); }

double product(const std::array<double, 3> &n) { return n[0] * n[1] * n[2]; }

}  // namespace

Bounds bounds_of(std::span<const Photon> photons) {
  Bounds box;
  bool any = false;
  for (const Photon &p : photons) {
    const bool somewhere = std::isfinite(p.place_m[0]) && std::isfinite(p.place_m[1]) && std::isfinite(p.place_m[2]);
    if (PHOTON_KIND(p.tags) == PHOTON_NONE || !somewhere) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double place = static_cast<double>(p.place_m[axis]);
      box.low_m[axis] = any ? std::min(box.low_m[axis], place) : place;
      box.high_m[axis] = any ? std::max(box.high_m[axis], place) : place;
    }
    any = true;
  }
  return box;
}

PhotonGrid plan_grid(const Bounds &bounds, double cell_m, std::size_t most_cells) {
  if (!(cell_m > 0) || !std::isfinite(cell_m)) throw RunError("the photon map needs a cell size above 0");
  const double most = static_cast<double>(std::max<std::size_t>(most_cells, 64));
  PhotonGrid grid{};
  double cell = cell_m;
  const auto wanted = [&](std::size_t axis) {
    return std::max(1.0, std::floor((bounds.high_m[axis] - bounds.low_m[axis]) / cell) + 1);
  };
  // Whole rows: at least four by four of them must have room. (Cells below a millionth of the box are rounding anyway.)
  while (wanted(0) * std::min(4.0, wanted(1)) * std::min(4.0, wanted(2)) > most) cell *= 1.5;
  std::array<double, 3> cells{wanted(0), wanted(1), wanted(2)};
  grid.wrap = product(cells) > most;
  if (grid.wrap) {
    cells[1] = power_of_two_below(cells[1]);
    cells[2] = power_of_two_below(cells[2]);
    while (product(cells) > most) (cells[1] > cells[2] ? cells[1] : cells[2]) /= 2;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.origin_m[axis] = static_cast<float>(bounds.low_m[axis]);
    grid.cells[axis] = static_cast<int>(cells[axis]);
  }
  grid.per_m = static_cast<float>(1 / cell);
  return grid;
}

}  // namespace greenray
