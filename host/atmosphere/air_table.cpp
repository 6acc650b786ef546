#include "atmosphere/air_table.hpp"

#include <algorithm>
#include <cmath>

#include "support/error.hpp"

namespace greenray {
namespace {

constexpr double huge_m = 1e30;

/// n^2 and its slope; constant beyond the ends of the medium.
Dual index2(const LayeredMedium &medium, double height_m, double nm) {
  const double top = medium.top_m > 0 ? medium.top_m : huge_m;
  const double within = std::clamp(height_m, 0.0, top);
  const Dual r = medium.refractivity(within, nm);
  const Dual n{1 + r.value, r.slope};
  const Dual squared = n * n;
  return within == height_m ? squared : Dual{squared.value, 0};
}

using Row = std::vector<surface64::AirCell>;

/// Knots of the table: heights, and which of them are kinks.
struct Knots {
  std::vector<double> height_m;
  std::vector<bool> kink;
};

Row row_of(const LayeredMedium &medium, double nm, const Knots &knots) {
  const std::size_t count = knots.height_m.size();
  std::vector<double> value(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double z = knots.height_m[k];
    value[k] = index2(medium, z, nm).value;
    if (knots.kink[k]) continue;
    const double below = z - knots.height_m[k - 1], above = knots.height_m[k + 1] - z,
                 step = 0.25 * std::min(below, above);
    const double second = (index2(medium, z + step, nm).slope - index2(medium, z - step, nm).slope) / (2 * step);
    value[k] -= (below * below + above * above) / 24 * second;
  }
  Row row{{-huge_m, 0, value.front(), 0}};
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const double thickness = knots.height_m[k + 1] - knots.height_m[k];
    row.push_back({knots.height_m[k], (value[k + 1] - value[k]) / thickness / 4, value[k], 0});
  }
  row.push_back({knots.height_m.back(), 0, value.back(), 0});
  return row;
}

struct Start {
  double height_m, elevation_rad;
};

/// Heights of a test path at sixteen even steps of sigma.
std::vector<double> heights_on_path(const Row &row, const Start &start, double length_m) {
  const int cells = static_cast<int>(row.size());
  int cell = surface64::find_air_cell(row.data(), cells, start.height_m);
  const surface64::AirCell &first = row[static_cast<std::size_t>(cell)];
  const double n2 = first.index2 + (first.bend != 0 ? 4 * first.bend * (start.height_m - first.bottom_m) : 0);
  double z = start.height_m, p = std::sqrt(n2) * std::sin(start.elevation_rad), sigma = 0;
  const double step = length_m / std::sqrt(n2) / 16;
  std::vector<double> heights;
  for (int i = 0; i < 20000 && heights.size() < 16; ++i) {
    const surface64::AirCell &here = row[static_cast<std::size_t>(cell)];
    const double top = cell + 1 < cells ? row[static_cast<std::size_t>(cell) + 1].bottom_m : huge_m;
    const surface64::CellExit leaving = surface64::leave_cell(p, here.bend, top - z, here.bottom_m - z);
    const double left = step * static_cast<double>(heights.size() + 1) - sigma;
    if (leaving.sigma >= left || leaving.step == 0) {
      z += (p + here.bend * left) * left, p += 2 * here.bend * left, sigma += left;
      heights.push_back(z);
    } else {
      z = leaving.step > 0 ? top : here.bottom_m, p = leaving.momentum_z, sigma += leaving.sigma;
      cell += leaving.step;
    }
  }
  heights.resize(16, z);
  return heights;
}

/// From between the kinks, level to steep, up and down. (A level path on a kink itself may go either way.)
std::vector<Start> test_fan(const Knots &knots) {
  std::vector<Start> fan;
  std::vector<double> from;
  for (std::size_t k = 0; k < knots.height_m.size(); ++k) {
    if (!knots.kink[k]) continue;
    if (k + 1 < knots.height_m.size()) {
      std::size_t next = k + 1;
      while (!knots.kink[next]) ++next;
      for (double t : {0.05, 0.21, 0.5, 0.83, 0.95})
        from.push_back(knots.height_m[k] + t * (knots.height_m[next] - knots.height_m[k]));
    }
  }
  for (const double height : from)
    for (const double degrees : {0.0, 0.3, 1.0, 3.0, 8.0, 20.0, 45.0, 75.0})
      for (const double sign : {1.0, -1.0}) fan.push_back({height, sign * degrees * M_PI / 180});
  return fan;
}

double largest_difference(const Row &coarse, const Row &fine, const std::vector<Start> &fan, double length_m) {
  double worst = 0;
  constexpr double nudge_rad = 1e-6;
  for (const Start &start : fan) {
    const auto a = heights_on_path(coarse, start, length_m), b = heights_on_path(fine, start, length_m);
    const auto c = heights_on_path(fine, {start.height_m, start.elevation_rad + nudge_rad}, length_m);
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double amplified = std::abs(c[i] - b[i]) / nudge_rad / length_m;
      worst = std::max(worst, std::abs(a[i] - b[i]) / std::max(1.0, amplified));
    }
  }
  return worst;
}

Knots kinks_of(const LayeredMedium &medium, const AirTableOptions &options) {
  const double top = medium.top_m > 0 ? medium.top_m : options.high_m;
  const double low = std::max(options.low_m, 0.0), high = std::min(std::max(options.high_m, low + 1e-3), top);
  Knots knots;
  knots.height_m.push_back(std::min(low, high));
  for (const double kink : medium.kinks_m)
    if (kink > low && kink < high) knots.height_m.push_back(kink);
  if (high > low) knots.height_m.push_back(high);
  knots.kink.assign(knots.height_m.size(), true);
  return knots;
}

/// Halves the cells in which n^2 leaves its chord by more than `most`.
Knots refined(const LayeredMedium &medium, double nm, const Knots &kinks, double most, double most_cells) {
  Knots out;
  struct Piece {
    double low, high;
  };
  for (std::size_t k = 0; k + 1 < kinks.height_m.size(); ++k) {
    std::vector<Piece> open{{kinks.height_m[k], kinks.height_m[k + 1]}};
    out.height_m.push_back(kinks.height_m[k]);
    out.kink.push_back(true);
    while (!open.empty()) {
      const Piece piece = open.back();
      open.pop_back();
      const double a = index2(medium, piece.low, nm).value, b = index2(medium, piece.high, nm).value;
      double off = 0;
      for (const double t : {0.2, 0.4, 0.5, 0.6, 0.8})
        off = std::max(off,
                       std::abs(index2(medium, piece.low + t * (piece.high - piece.low), nm).value - a - t * (b - a)));
      if (off > most) {
        const double middle = 0.5 * (piece.low + piece.high);
        open.push_back({middle, piece.high});
        open.push_back({piece.low, middle});
        if (static_cast<double>(out.height_m.size() + open.size()) > most_cells)
          throw InputError(medium.place, "this medium needs more than " + std::to_string(static_cast<int>(most_cells)) +
                                             " cells for paths among surfaces: smooth it, or ask for a larger error");
        continue;
      }
      if (piece.low != kinks.height_m[k]) out.height_m.push_back(piece.low), out.kink.push_back(false);
    }
  }
  out.height_m.push_back(kinks.height_m.back());
  out.kink.push_back(true);
  return out;
}

}  // namespace

AirTable build_air_table(const LayeredMedium &medium, const std::vector<double> &wavelength_nm,
                         const AirTableOptions &options) {
  const double nm = wavelength_nm[wavelength_nm.size() / 2];
  const Knots kinks = kinks_of(medium, options);
  const std::vector<Start> fan = test_fan(kinks);
  // Below this the difference of two tables is rounding: n^2 itself is good to 1e-16.
  constexpr double least = 1e-13;
  double most = 1e-3;
  Knots knots = refined(medium, nm, kinks, most, options.most_cells);
  AirTable table;
  for (;; most /= 4) {
    const Knots finer = refined(medium, nm, kinks, most / 16, options.most_cells);
    table.error_m = largest_difference(row_of(medium, nm, knots), row_of(medium, nm, finer), fan, options.length_m);
    if (table.error_m <= options.error_m || most < least) break;
    knots = refined(medium, nm, kinks, most / 4, options.most_cells);
  }
  table.wavelength_nm = wavelength_nm;
  table.cells = knots.height_m.size() + 1;
  for (const double wave : wavelength_nm) {
    const Row row = row_of(medium, wave, knots);
    table.rows.insert(table.rows.end(), row.begin(), row.end());
  }
  for (const surface64::AirCell &cell : table.rows)
    table.largest_bend_per_m = std::max(table.largest_bend_per_m, std::abs(cell.bend));
  return table;
}

AirTable uniform_air(double refractivity, const std::vector<double> &wavelength_nm) {
  AirTable table;
  table.wavelength_nm = wavelength_nm;
  const double n = 1 + refractivity;
  table.rows.assign(wavelength_nm.size(), surface64::AirCell{-huge_m, 0, n * n, 0});
  return table;
}

std::vector<surface32::AirCell> AirTable::narrowed() const {
  std::vector<surface32::AirCell> out;
  for (const surface64::AirCell &c : rows)
    out.push_back({static_cast<float>(c.bottom_m), static_cast<float>(c.bend), static_cast<float>(c.index2), 0});
  return out;
}

}  // namespace greenray
