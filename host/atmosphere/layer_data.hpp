// Layers and far nodes in double; converted to the device's precision on upload. Fields as in kernels/shared/layers.h.
#pragma once
#include <array>

namespace greenray {

inline constexpr int layer_quantities = 6;  // LAYER_QUANTITIES

/// As struct Layer.
struct LayerData {
  double lift, bulge, skew, far_m;
  std::array<double, layer_quantities> mean, tilt, bow;
};

/// As struct FarNode.
struct FarNode {
  double lift;
  std::array<double, layer_quantities> weight;
};

}  // namespace greenray
