// n(h, lambda) tabulated for the device: rows of cells, each a cubic of d(ln n)/dz (kernels/shared/index_table.h).
#pragma once
#include <functional>
#include <vector>

#include "atmosphere/profile.hpp"

namespace greenray {

/// One cell in double; converted to the device's precision on upload. Fields as in kernels/shared/index_table.h.
struct IndexCellData {
  double gradient[4];
  double bottom_m, thickness_m, log_index, step_cap_m;
  double density[4];
};

struct IndexTable {
  double curvature_per_m = 0;         // 1/R, 0 for a flat surface
  std::vector<double> wavelength_nm;  // one row each
  std::size_t cells_per_row = 0;
  std::vector<IndexCellData> cells;  // [wavelengths][cells_per_row], cell fastest
  double bound_arcsec = 0;           // the builder's own bound of the bending error of one grazing ray

  double top_m() const { return cells[cells_per_row - 1].bottom_m + cells[cells_per_row - 1].thickness_m; }
  const IndexCellData &cell(std::size_t row, std::size_t i) const { return cells[row * cells_per_row + i]; }
  /// Cell that holds a flattened height (clamped to the table).
  std::size_t find(double z_m) const;
  /// ln n at a flattened height inside the table, from the table itself.
  double log_index(std::size_t row, double z_m) const;
};

/// Any medium in layers, for the builder: air from a Profile, or a closed form in a test.
struct LayeredMedium {
  std::function<Dual(double height_m, double wavelength_nm)> refractivity;  // n-1 and its slope by height [1/m]
  std::function<double(double height_m)> density_kg_m3;                     // for air mass and extinction
  std::vector<double> kinks_m;                                              // ascending: where a slope jumps
  std::vector<double> features_m;                                           // ascending: where it changes quickly
  double top_m = 0;                                                         // vacuum above
  double radius_m = 0;  // of the sphere whose surface is height 0; 0: flat
  SourcePlace place;    // for complaints
};

/// The medium of a profile. The profile must outlive it.
LayeredMedium layered_medium(const Profile &profile, bool flat);

struct IndexTableOptions {
  bool flat = false;            // of a Profile
  double error_arcsec = 0.003;  // wanted: error of the bending of a grazing ray that this table causes
  double observer_m = 0;        // a vacuum cell is added when the eye is above the air
};

/// Places the knots by itself: cells end at kinks and are halved until the cubic's residual, held for the longest path
/// a ray can spend in the cell, bends by less than the error asked for. Throws InputError when that needs more than
/// 100000 cells.
IndexTable build_index_table(const LayeredMedium &medium, const std::vector<double> &wavelength_nm,
                             const IndexTableOptions &options);
IndexTable build_index_table(const Profile &profile, const std::vector<double> &wavelength_nm,
                             const IndexTableOptions &options);

}  // namespace greenray
