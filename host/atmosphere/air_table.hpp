// A flat stratified medium as cells in which n^2 is a cubic of the height, for paths among surfaces
// (kernels/shared/air_cell.h).
#pragma once
#include <vector>

#include "atmosphere/index_table.hpp"
#include "twin/surface_twin.hpp"

namespace greenray {

struct AirTableOptions {
  double low_m = 0, high_m = 0;  // heights where surfaces are: the medium is tabulated there and in its own extent
  double length_m = 10;          // of the paths whose error is asked for
  double error_m = 1e-4;         // wanted: error of places on a path that the table and its arcs cause
  double most_cells = 4096;
};

struct AirTable {
  std::vector<double> wavelength_nm;        // one row each
  std::vector<surface64::AirLayer> layers;  // upwards, with the endless ones
  std::size_t cells = 1;                    // of a row
  std::vector<surface64::AirCell> rows;     // [wavelengths][cells], cell fastest
  // Largest over a fan of test paths, against a finer table and shorter arcs; scaled by max(1, |dz/da|/length), so that
  // it is what no change of direction by error/length could tell.
  double error_m = 0;
  double largest_bend_per_m = 0;  // |d n^2/dz|/4
  double extinction_per_m = 0;

  bool is_straight() const { return largest_bend_per_m == 0; }
  /// Difference between wavelengths of the bend, averaged over the tabulated heights [1/m].
  double parting_per_m() const;
  std::vector<surface32::AirLayer> narrowed_layers() const;
  std::vector<surface32::AirCell> narrowed() const;
};

/* Layers end at the medium's kinks, and where the slope of d n^2/dz changes so much that arcs could be much longer on
   one side than on the other. Their cells are halved until d n^2/dz is good for the error asked for along a whole path,
   the longest arcs chosen so that no arc is farther off its path than half of it. Outside the table n stays what it is
   at its ends. medium: flat (radius_m 0); heights below 0 and above top_m have the index there errors: InputError when
   it takes more than most_cells */
AirTable build_air_table(const LayeredMedium &medium, const std::vector<double> &wavelength_nm,
                         const AirTableOptions &options);

/// The same index everywhere. refractivity: n-1, for all wavelengths.
AirTable uniform_air(double refractivity, const std::vector<double> &wavelength_nm);

}  // namespace greenray
