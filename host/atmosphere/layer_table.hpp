// The layers of the closed form (kernels/ray/closed_form.h): placed by themselves, weighed in double.
#pragma once
#include <array>
#include <vector>

#include "atmosphere/index_table.hpp"

namespace greenray {

inline constexpr int layer_quantities = 6;  // LAYER_QUANTITIES of kernels/shared/layers.h

/// As struct Layer of kernels/shared/layers.h.
struct LayerData {
  double lift, bulge, skew, far_m;
  std::array<double, layer_quantities> mean, tilt, bow;
};

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
  std::vector<LayerSide> above, below;  // per wavelength; the same heights in all
};

/// Shapes of ozone and aerosol, for their columns.
struct LayerAbsorbers {
  double ozone_peak_m = 22000, ozone_width_m = 5000, aerosol_scale_m = 1200;
};

/// Layer edges (flattened heights) for a medium: ends of the fine table's kinks, halved until each layer's closed form
/// agrees with its two halves to error_arcsec for rays that graze its lower edge, turn in its middle, or cross it.
/// `fine` must be a good deal more accurate than error_arcsec. eye_m becomes an edge.
std::vector<double> place_layers(const IndexTable &fine, std::size_t row, double eye_m, double error_arcsec);

LayerTable build_layer_table(const IndexTable &fine, const std::vector<double> &edges_m, double eye_m,
                             const LayerAbsorbers &absorbers);

}  // namespace greenray
