// Terrain around an eye, over azimuth and distance.
#pragma once
#include <vector>

#include "render/renderer.hpp"
#include "twin/twin.hpp"

namespace greenray {

/* Rows of samples along geodesics from the eye (kernels/shared/terrain.h). Land below the surface of the sea counts as
   sea. Samples stand half as far apart as the nodes of the files, columns so far that they do at the farthest distance,
   but no closer than half a pixel. */
struct PolarTerrain {
  int columns = 0, samples = 0;
  double first_azimuth_rad = 0, step_rad = 0;  // from the picture's centre, clockwise
  std::vector<f32::TerrainBlock> blocks;       // and where the last one ends
  std::vector<double> block_m;                 // where they begin, and where the last one ends
  std::vector<float> heights;                  // [columns][samples]
  std::vector<short> slopes;                   // [columns][samples][2]
  std::vector<float> tops;                     // [columns][blocks]
  double highest_m = 0;
  double error_arcsec = 0;  // of heights half way between samples and columns, as an angle at the eye, RMS
};

/// errors: InputError where the files have no heights, with the tiles that would
PolarTerrain polar_terrain(const Scene &scene, const RenderPlan &plan);

/// Throws the same for tiles that are missing, looking at a point each kilometre: quick.
void require_tiles(const Scene &scene, const RenderPlan &plan);

}  // namespace greenray
