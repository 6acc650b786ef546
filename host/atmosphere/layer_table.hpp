// The layers of the closed form (kernels/ray/closed_form.h): placed by themselves, weighed in double.
#pragma once
#include <array>
#include <vector>

#include "atmosphere/index_table.hpp"
#include "atmosphere/layer_data.hpp"

namespace greenray {

/// The layers of one wavelength on one side of the eye, from the eye outwards.
struct LayerSide {
  std::vector<LayerData> layers;
  double lowest_lift = 0;
};

struct LayerTable {
  double eye_m = 0;  // flattened height
  std::vector<double> wavelength_nm;
  std::vector<double> index_eye;        // N at the eye, per wavelength
  std::vector<bool> level_rises;        // does a level ray start upward?
  std::vector<LayerSide> above, below;  // per wavelength; the same number in all
  std::size_t near_above = 0;           // layers above the eye that are summed one by one; the nodes stand for the rest
  std::vector<std::vector<FarNode>> far;  // per wavelength; the same number in all, a multiple of 4
  double far_error_arcsec = 0;            // of bending, by the nodes, over all directions; measured
};

/// Shapes of ozone and aerosol, for their columns.
struct LayerAbsorbers {
  double ozone_peak_m = 22000, ozone_width_m = 5000, aerosol_scale_m = 1200;
};

/// Layer edges (flattened heights) for a medium: ends of the fine table's kinks, extremes of N, and halved until each
/// layer's closed form agrees with its two halves to error_arcsec for rays that graze its lower edge, turn in its
/// middle, or cross it. `fine` must be a good deal more accurate than error_arcsec. eye_m becomes an edge.
std::vector<double> place_layers(const IndexTable &fine, std::size_t row, double eye_m, double error_arcsec);

/// All layers; none merged.
LayerTable build_layer_table(const IndexTable &fine, const std::vector<double> &edges_m, double eye_m,
                             const LayerAbsorbers &absorbers);

/// Lets nodes stand for the layers far above the eye (host/atmosphere/far_nodes.hpp), as many as is cheapest, so that
/// bending stays good to error_arcsec and, unless bending_only, columns, distance and path to error_arcsec/1000
/// relatively.
void merge_far_layers(LayerTable &table, const IndexTable &fine, const LayerAbsorbers &absorbers, double error_arcsec,
                      bool bending_only);

}  // namespace greenray
