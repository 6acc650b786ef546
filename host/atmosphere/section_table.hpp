// n(h, x, lambda) tabulated for the device: columns along x of cells over height (kernels/shared/section_table.h).
#pragma once
#include <functional>
#include <vector>

#include "atmosphere/air_section.hpp"
#include "atmosphere/index_table.hpp"

namespace greenray {

/// One cell in double; converted to the device's precision on upload. Fields as in kernels/shared/section_table.h.
struct SectionCellData {
  double slope[16], base[4], density[4];
  double bottom_m, thickness_m, step_cap_m;
};

struct SectionColumnData {
  double left_m;   // of an open end: the point beyond which nothing varies
  double width_m;  // 0: an open end
  std::size_t first_cell, cells;
};

struct SectionRowData {
  double factor;
  std::size_t first_column;
  std::size_t columns;  // the first and the last are open ends; one alone where nothing varies
};

struct SectionTable {
  double curvature_per_m = 0;  // 1/R, 0 for a flat surface
  std::vector<double> wavelength_nm;
  std::vector<SectionRowData> rows;        // [wavelengths]
  std::vector<SectionColumnData> columns;  // of one section for all wavelengths of dry air, or of one for each
  std::vector<SectionCellData> cells;
  double bound_arcsec = 0;  // the builder's own bound of the bending error of one ray that grazes a cell

  const SectionColumnData &column(std::size_t row, std::size_t i) const { return columns[rows[row].first_column + i]; }
  /// Column that holds x; a point between two belongs to the one beyond it.
  std::size_t find_column(std::size_t row, double x_m) const;
  /// Cell of a column (counted from its bottom) that holds a flattened height; clamped to the table.
  std::size_t find_cell(const SectionColumnData &column, double z_m) const;
  /// n - 1 from the table itself.
  double refractivity(std::size_t row, double z_m, double x_m) const;
};

/// Any medium over a path, for the builder: air, or a closed form in a test.
struct SectionMedium {
  std::function<LayeredMedium(double x_m)> at;         // what stands over one place
  std::vector<double> points_m;                        // as AirSection::points_m
  std::function<double(double wavelength_nm)> factor;  // (n-1)/(n-1 at 550 nm), everywhere the same; none: not so
  double top_m = 0, radius_m = 0;                      // as in LayeredMedium
  SourcePlace place;                                   // for complaints
};

SectionMedium section_medium(const AirSection &air, bool flat);

struct SectionTableOptions {
  double error_arcsec = 0.003;  // wanted: error of the bending of a grazing ray that this table causes
  double observer_m = 0;        // a vacuum cell is added when the eye is above the air
};

/// Places columns and cells by itself. Columns end at the points of the medium and are halved until a cubic through
/// four Gauss-Legendre places of x gives the gradient everywhere; then, in each column, cells end at kinks and are
/// halved until the bicubic does. A residual counts as what it bends over the longest path that a ray can spend in the
/// cell: sqrt(8 dz R), or, of columns, their width if that is less.
/// errors: InputError when that needs more than 4 million cells
SectionTable build_section_table(const SectionMedium &medium, const std::vector<double> &wavelength_nm,
                                 const SectionTableOptions &options);

}  // namespace greenray
