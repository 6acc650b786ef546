// Waves: how much of a view low over the sea their crests hide.
#pragma once
#include <cstdint>
#include <vector>

#include "render/renderer.hpp"
#include "render/sight_places.hpp"
#include "render/transfer.hpp"

namespace greenray {

/// A sea of Gaussian waves, so far as the horizon depends on it.
struct SeaState {
  double height_m = 0;  // standard deviation of the surface: a quarter of the significant height
  double slope = 0;     // standard deviation along the line of sight
  /// Crests a metre that rise through the mean level, on average.
  double crests_per_m() const;
};
/* source: significant height 0.21 U^2/g with U at 19.5 m: Pierson & Moskowitz, J. Geophys. Res. 69 (1964) 5181; mean
   square slope 0.003 + 0.00512 U, half of it along any line of sight: Cox & Munk, J. Opt. Soc. Am. 44 (1954) 838;
   crossings: Rice, Bell Syst. Tech. J. 24 (1945) 46 */
SeaState sea_state(const SeaScene &sea);

/// Crests that rise into rays of sight, and where.
struct SeaSights {
  std::size_t stations = 0, wavelengths = 0;
  std::vector<float> crests;  // [entries][wavelengths][stations + 1]: mean number before each station, and in all
  double horizon_m = 0;       // how far away the crests that make the horizon stand
  std::size_t sea_entry = 0;  // whose rays all meet the sea just below the lowest horizon
  float at(std::size_t entry, std::size_t wave, std::size_t station) const {
    return crests[(entry * wavelengths + wave) * (stations + 1) + station];
  }
};

/* Along a ray whose height above the mean level is c(x), crests rise through it at a rate
   exp(-c^2/(2 s^2)) crests_per_m dx; rare and independent ones hide it with the probability 1 - exp(-their mean
   number). rays: of three wavelengths, the outermost ones and the middle, or of one; ln of the number goes between them
   by a parabola, for c is linear there. wavelengths: of the picture. Rays steep enough that waves change nothing have
   none. */
SeaSights trace_sea(SightPlaces &rays, const TransferTable &transfer, const std::vector<double> &station_m,
                    const SeaState &sea, double eye_m, double earth_radius_m, bool coarse);

/* One draw of the waves: the mean number of crests that hides a ray, over azimuth. Its values are distributed as
   -ln(uniform), so that a share exp(-number) of all azimuths is clear; neighbours resemble each other over an angle
   `width_rad`: a Gaussian process of many random cosines, brought to that distribution. */
std::vector<float> crest_thresholds(double first_rad, double step_rad, std::size_t count, double width_rad,
                                    std::uint64_t seed);

}  // namespace greenray
