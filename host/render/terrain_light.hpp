// Terrain in the light of a picture: what the kernel is told of it (kernels/shared/terrain.h).
#pragma once
#include "render/sky.hpp"
#include "render/terrain_sights.hpp"

namespace greenray {

/// Heights and rays alone: where rays meet terrain. Looks at what it is given, which must outlive it.
TerrainTable terrain_shape(const PolarTerrain &terrain, const TerrainSights &sights);

/* Lambert ground: the Sun by the slope, as the air leaves it at the eye, and half a sky; through the extinction and
   airlight of each ray's own way.
   waves: of the picture, padded;  sea_horizon_m: waves hide what stands farther away, 0: no waves
   returns: looks at `terrain` and `sights`, which must outlive it */
TerrainTable make_terrain_table(const Scene &scene, const SkyLight &light, const std::vector<double> &wavelengths_nm,
                                const PolarTerrain &terrain, const TerrainSights &sights, int waves,
                                double sea_horizon_m);

}  // namespace greenray
