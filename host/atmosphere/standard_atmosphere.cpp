#include "atmosphere/standard_atmosphere.hpp"

namespace greenray::us76 {

Dual temperature_K(double height_m) {
  const double geopotential = geopotential_m(height_m);
  const double stretch = earth_radius_m / (earth_radius_m + height_m);
  std::size_t i = layers.size() - 1;
  while (i > 0 && height_m < geometric_m(layers[i].base_gpm)) --i;
  const Layer &layer = layers[i];
  return {layer.base_K + layer.lapse_K_gpm * (geopotential - layer.base_gpm), layer.lapse_K_gpm * stretch * stretch};
}

}  // namespace greenray::us76
