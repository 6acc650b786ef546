// Where the rays of an eye pass above its terrain: what of a picture of terrain does not depend on light.
#pragma once
#include <vector>

#include "render/polar_terrain.hpp"
#include "render/targets.hpp"
#include "render/transfer_curve.hpp"

namespace greenray {

struct TerrainSights {
  std::vector<double> elevation_rad;  // of the nodes
  std::vector<float> node_entry;      // their places among the entries of the transfer table
  std::vector<int> first_node;        // of each entry
  std::size_t waves = 0;              // 1, or all of the picture, padded
  std::vector<float> rays, grounded;  // kernels/shared/terrain.h
  int words = 0, blocks_per_light = 1;
  std::vector<unsigned int> masks;
  StationSights light;      // where light is looked up
  double error_arcsec = 0;  // of heights half way between nodes and blocks, as an angle at the eye
};

/// Of whose rays the sights are.
struct RaysOfSight {
  const AirSection &air;
  SkyRayOptions options;
  bool section = false;
  std::shared_ptr<Device> device;
};

/* Nodes are those of the transfer curve, and as many more until heights along all of the terrain are linear between
   them to 0.02 pixel at the eye, for the outermost wavelengths and the middle one.
   bent_nm: wavelengths that have rays of their own;  padded: of the picture, in whole groups of lanes */
TerrainSights trace_terrain(const RaysOfSight &from, const std::vector<double> &bent_nm, std::size_t padded,
                            const PolarTerrain &terrain, const TransferCurve &curve, const TransferTable &transfer,
                            double pixel_rad);

}  // namespace greenray
