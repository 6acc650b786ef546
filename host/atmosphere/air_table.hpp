// A flat stratified medium as cells in which n^2 is linear in height: paths among surfaces are exact parabolas in each
// (kernels/shared/air_cell.h).
#pragma once
#include <vector>

#include "atmosphere/index_table.hpp"
#include "twin/surface_twin.hpp"

namespace greenray {

struct AirTableOptions {
  double low_m = 0, high_m = 0;  // heights where surfaces are: the medium is tabulated there and in its own extent
  double length_m = 10;          // of the paths whose error is asked for
  double error_m = 1e-4;         // wanted: error of places on a path that the table causes
  double most_cells = 4096;
};

struct AirTable {
  std::vector<double> wavelength_nm;     // one row each
  std::size_t cells = 1;                 // of a row
  std::vector<surface64::AirCell> rows;  // [wavelengths][cells], cell fastest
  // Largest over a fan of test paths, against a finer table; scaled by max(1, |dz/da|/length), so that it is what no
  // change of direction by error/length could tell.
  double error_m = 0;
  double largest_bend_per_m = 0;  // |d n^2/dz|/4
  double extinction_per_m = 0;

  bool is_straight() const { return largest_bend_per_m == 0; }
  std::vector<surface32::AirCell> narrowed() const;
};

/* Cells end at the medium's kinks; between them they are halved until the fan of test paths agrees with that of a finer
   table. Knots carry n^2 shifted by -(H^2/12)(n^2)'', so that the integral over a cell is right and not only its ends
   (not at kinks). Outside the table n stays what it is at its ends.
   medium: flat (radius_m 0); heights below 0 and above top_m have the index there
   errors: InputError when it takes more than most_cells */
AirTable build_air_table(const LayeredMedium &medium, const std::vector<double> &wavelength_nm,
                         const AirTableOptions &options);

/// The same index everywhere. refractivity: n-1, for all wavelengths.
AirTable uniform_air(double refractivity, const std::vector<double> &wavelength_nm);

}  // namespace greenray
