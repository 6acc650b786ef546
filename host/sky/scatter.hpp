// Light scattered into a line of sight: sums over the places of its path.
#pragma once
#include <vector>

#include "sky/diffuse_light.hpp"

namespace greenray {

/// A path made ready for scattering: at each place, what share of the light there air and aerosol scatter to its start,
/// dimmed on the way. Shares are optical depths of scattering times the transmittance, split between the ends of each
/// piece, exact for light that is constant along it.
struct ScatterPath {
  /// A place as the Sun's geometry needs it.
  struct Place {
    double sine, cosine;                // of the path's elevation there
    double turned_sine, turned_cosine;  // of the angle at the Earth's centre between start and place
    double seen_sine, seen_cosine;      // of its elevation in the frame of the start
    Sunlight::Height for_sunlight;
    DiffuseLight::Height for_diffuse;
  };
  PathEnd end = PathEnd::space;
  std::vector<PathPlace> places;
  std::vector<Place> geometry;       // [places]
  std::vector<float> air, aerosol;   // [places][padded]
  std::vector<float> transmittance;  // [padded], of the whole path
};
ScatterPath scatter_path(const AirShells &shells, const SkyOptics &optics, const Sunlight &sunlight,
                         const DiffuseLight &diffuse, AirPath path, double elevation_rad);

/// The Sun at a place on a path whose start sees it at an altitude and azimuth from the line of sight.
struct SunAtPlace {
  double altitude_rad;  // true, above the horizontal of that place
  double up, sunward;   // the line of sight along the vertical and along the horizontal towards the Sun
};
struct SunOfStart {
  double sine, cosine;  // of its true altitude
  double cos_azimuth;
};
SunAtPlace sun_at(const ScatterPath::Place &place, const SunOfStart &sun);

/// Where the light comes from; either may be null. Both for a Sun of irradiance 1 outside the air.
struct SkySources {
  const Sunlight *sun = nullptr;          // scattered once
  const DiffuseLight *diffuse = nullptr;  // scattered again
  double ground_albedo = 0;
};

/// Adds the radiance [1/sr] that the path scatters to its start, for the Sun at a true altitude seen from there, and
/// cos_azimuth of the angle between its azimuth and the path's. radiance: all; haze_once: where not null, the part that
/// the aerosol scatters of direct sunlight goes there instead. [padded]
void add_scattered(const ScatterPath &path, const SkyOptics &optics, const SkySources &sources, double sun_altitude_rad,
                   double cos_azimuth, float *radiance, float *haze_once = nullptr);

/// Adds what a Lambertian ground at the path's end sends along it. `sunlight` lights it directly where sources.sun is
/// given or sources.diffuse is null.
void add_lambert_ground(const ScatterPath &path, const Sunlight &sunlight, const SkySources &sources,
                        double sun_altitude_rad, double cos_azimuth, float *radiance);

}  // namespace greenray
