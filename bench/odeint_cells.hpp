// The tabulated medium as the odeint peers read it.
#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "bench/peer.hpp"

namespace greenray::bench {

/// classical: geometric height h and arc length; flattened: z = R ln(1 + h/R).
enum class Form { classical, flattened };

/// One cubic of n'/n in the form's own height.
struct OdeCell {
  double bottom_m, top_m, per_thickness, gradient[4];
  double at(double height_m) const {
    const double t = (height_m - bottom_m) * per_thickness;
    return gradient[0] + t * (gradient[1] + t * (gradient[2] + t * gradient[3]));
  }
};

/// The cubic through four points t = 0, 1/3, 2/3, 1 is exact for a cubic.
inline void fit(const std::array<double, 4> &y, double (&c)[4]) {
  c[0] = y[0];
  c[1] = -5.5 * y[0] + 9 * y[1] - 4.5 * y[2] + y[3];
  c[2] = 9 * y[0] - 22.5 * y[1] + 18 * y[2] - 4.5 * y[3];
  c[3] = -4.5 * y[0] + 13.5 * y[1] - 13.5 * y[2] + 4.5 * y[3];
}

/// A cell of the index table. For the classical form the flattened table's gradient per geometric metre is sampled at
/// four points and fitted anew, so that no logarithm is taken on the way.
inline OdeCell ode_cell(const IndexCellData &data, double curvature_per_m, Form form) {
  OdeCell cell{data.bottom_m, data.bottom_m + data.thickness_m, 1 / data.thickness_m, {}};
  std::copy(data.gradient, data.gradient + 4, cell.gradient);
  if (form == Form::flattened || curvature_per_m == 0) return cell;
  const OdeCell flat = cell;
  cell.bottom_m = f64::geometric_height_m(flat.bottom_m, curvature_per_m);
  cell.top_m = f64::geometric_height_m(flat.top_m, curvature_per_m);
  cell.per_thickness = 1 / (cell.top_m - cell.bottom_m);
  std::array<double, 4> y{};
  for (std::size_t i = 0; i < 4; ++i) {
    const double h = cell.bottom_m + (cell.top_m - cell.bottom_m) * static_cast<double>(i) / 3;
    y[i] = flat.at(f64::flattened_height_m(h, curvature_per_m)) / (1 + h * curvature_per_m);
  }
  fit(y, cell.gradient);
  return cell;
}

inline std::vector<OdeCell> ode_cells(const IndexTable &table, Form form) {
  std::vector<OdeCell> cells;
  for (std::size_t i = 0; i < table.cells_per_row; ++i)
    cells.push_back(ode_cell(table.cell(0, i), table.curvature_per_m, form));
  return cells;
}

}  // namespace greenray::bench
