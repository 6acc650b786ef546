// Targets before the sky: what the kernel is told of them (kernels/shared/target.h).
#pragma once
#include <vector>

#include "compute/sky_shader.hpp"
#include "render/renderer.hpp"
#include "render/sea.hpp"
#include "render/sight_places.hpp"
#include "render/sky.hpp"

namespace greenray {

/// Distances of a scene's targets, ascending, each once.
std::vector<double> station_distances_m(const Scene &scene);

/// Where the rays of a transfer table's entries pass the stations.
struct StationSights {
  std::vector<double> station_m, elevation_rad;
  std::size_t wavelengths = 0;     // 1: one serves all
  std::vector<SightPlace> places;  // [elevations][wavelengths][stations]
  const SightPlace &at(std::size_t entry, std::size_t wave, std::size_t station) const {
    return places[(entry * wavelengths + (wavelengths > 1 ? wave : 0)) * station_m.size() + station];
  }
};
StationSights trace_stations(SightPlaces &rays, const std::vector<double> &elevations_rad,
                             const std::vector<double> &station_m, const std::vector<double> &azimuths_rad = {});

/// Largest error of interpolated heights half way between entries, as an angle at the eye [arcsec]: over the distance,
/// or over |d height/d elevation| where that is more. `middles` lie half way after the entries `below`; jumps are left
/// out.
double station_error_arcsec(const StationSights &entries, const std::vector<float> &edges,
                            const std::vector<std::size_t> &below, const StationSights &middles);

/// What of the targets no ray changes: outlines, pictures, and where they stand in the picture.
/// errors: a picture that cannot be read -> InputError
struct TargetShapes {
  std::vector<f32::Target> rows;    // farthest first
  std::vector<std::size_t> number;  // row of the scene of each
  std::vector<float> corners;
  std::vector<f32::TargetTexel> texels;
};
TargetShapes target_shapes(const Scene &scene, const std::vector<double> &station_m);

/// The waves of a picture: what they hide, and one draw of them over its azimuths. sights: null: a smooth sea.
struct SeaDraw {
  const SeaSights *sights = nullptr;
  std::vector<float> thresholds;
  double first_rad = 0, step_rad = 1;
};
/// half_width_rad: azimuths from the picture's middle to beyond its sides.
SeaDraw draw_sea(const SeaSights &sights, const SeaState &state, double half_width_rad, double pixel_rad,
                 std::uint64_t seed);

/// edges: as TransferTable.edges, empty: no jumps. waves: padded.
TargetTable make_target_table(const Scene &scene, const TargetShapes &shapes, const SkyLight &light,
                              const std::vector<double> &wavelengths_nm, const StationSights &sights,
                              const std::vector<float> &edges, const SeaDraw &sea, int waves);

}  // namespace greenray
