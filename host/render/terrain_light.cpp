#include "render/terrain_light.hpp"

#include <cmath>

#include "image/uplift.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

std::vector<float> shine_of(const Scene &scene, const SkyLight &light, const std::vector<double> &wavelengths_nm,
                            std::size_t padded) {
  const std::array<double, 3> &colour = scene.terrain.reflectance;
  Uplift uplift;
  const bool grey = colour[0] == colour[1] && colour[1] == colour[2];
  const CurveCoefficients curve = grey ? CurveCoefficients{} : uplift.coefficients(colour);
  std::vector<float> shine(2 * padded);
  for (std::size_t w = 0; w < wavelengths_nm.size(); ++w) {
    const double reflectance = grey ? colour[0] : curve_value(curve, wavelengths_nm[w]);
    const GroundLight ground = light_on_ground(light, w);
    shine[w] = static_cast<float>(reflectance / pi * ground.sun);
    shine[padded + w] = static_cast<float>(reflectance / pi * ground.sky);
  }
  return shine;
}

/// [nodes][stations][TERRAIN_CHANNEL_COUNT][padded]
std::vector<float> light_before(const SkyLight &light, const StationSights &sights, std::size_t wavelengths,
                                std::size_t padded) {
  const std::size_t nodes = sights.elevation_rad.size(), stations = sights.station_m.size();
  std::vector<float> table(nodes * stations * f32::TERRAIN_CHANNEL_COUNT * padded);
  std::vector<SkyGlow::AirBefore> airs;
  if (light.glow)
    for (const double distance_m : sights.station_m) airs.push_back(light.glow->air_before(distance_m));
  for (std::size_t n = 0; n < nodes; ++n)
    for (std::size_t s = 0; s < stations; ++s)
      for (std::size_t w = 0; w < wavelengths; ++w) {
        const SightPlace &place = sights.at(n, w, s);
        Transfer path{};
        path.column = place.column;
        path.bending_rad = place.bending_rad;
        path.true_altitude_rad = sights.elevation_rad[n] - place.bending_rad;
        const PathLight air = light_of_path(light, path, airs.empty() ? nullptr : &airs[s], w);
        float *at = &table[(n * stations + s) * f32::TERRAIN_CHANNEL_COUNT * padded + w];
        at[f32::TERRAIN_PASSED * padded] = static_cast<float>(air.passed);
        at[f32::TERRAIN_AIRLIGHT * padded] = static_cast<float>(air.isotropic);
        at[f32::TERRAIN_AUREOLE * padded] = static_cast<float>(air.aureole);
        at[f32::TERRAIN_FROM_SUN * padded] = static_cast<float>(path.true_altitude_rad - light.sun.true_altitude_rad);
      }
  return table;
}

void set_sun(const Scene &scene, const SkyLight &light, f32::TerrainScale &scale) {
  const double altitude = light.sun.true_altitude_rad;
  scale.sun_sin_altitude = static_cast<float>(std::sin(altitude));
  scale.sun_cos_altitude = static_cast<float>(std::cos(altitude));
  scale.sun_azimuth_rad = static_cast<float>(light.sun.azimuth_rad);
  scale.curvature_per_m = static_cast<float>(1 / scene.atmosphere.profile.earth_radius_m);
}

}  // namespace

TerrainTable terrain_shape(const PolarTerrain &terrain, const TerrainSights &sights) {
  TerrainTable table;
  table.heights = terrain.heights, table.slopes = terrain.slopes, table.tops = terrain.tops;
  table.blocks = terrain.blocks;
  table.node_entry = sights.node_entry, table.first_node = sights.first_node;
  table.rays = sights.rays, table.grounded = sights.grounded, table.masks = sights.masks;
  f32::TerrainScale &scale = table.scale;
  scale.columns = terrain.columns, scale.samples = terrain.samples;
  scale.blocks = static_cast<int>(terrain.blocks.size()) - 1, scale.words = sights.words;
  scale.nodes = static_cast<int>(sights.elevation_rad.size());
  scale.waves = static_cast<int>(sights.waves);
  scale.blocks_per_light = sights.blocks_per_light;
  scale.light_stations = static_cast<int>(sights.light.station_m.size());
  scale.first_azimuth_rad = static_cast<float>(terrain.first_azimuth_rad);
  scale.columns_per_rad = static_cast<float>(1 / terrain.step_rad);
  return table;
}

TerrainTable make_terrain_table(const Scene &scene, const SkyLight &light, const std::vector<double> &wavelengths_nm,
                                const PolarTerrain &terrain, const TerrainSights &sights, int waves,
                                double sea_horizon_m) {
  const auto padded = static_cast<std::size_t>(waves);
  TerrainTable table = terrain_shape(terrain, sights);
  table.light = light_before(light, sights.light, wavelengths_nm.size(), padded);
  table.shine = shine_of(scene, light, wavelengths_nm, padded);
  table.scale.sea_horizon_m = static_cast<float>(sea_horizon_m);
  set_sun(scene, light, table.scale);
  return table;
}

}  // namespace greenray
