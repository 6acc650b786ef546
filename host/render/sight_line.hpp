// What surveyors and photographers ask about a target at a distance: how much of it the Earth hides, where it is seen
// and how often, and the coefficient of refraction k of the line of sight.
#pragma once
#include <algorithm>
#include <vector>

#include "render/near_rays.hpp"

namespace greenray {

/* Height above the surface below which nothing is seen at distance_m, over a sphere, when light curves k times as much
   as the surface: in air of n = n0 (R/r)^k, exactly. height_m: of the eye, >= 0;  k: below 1 (1 and more hide nothing);
   returns: [m]; 0 up to the horizon source: Bouguer; about d^2 (1 - k)/2R at d beyond the horizon */
double hidden_height_m(double earth_radius_m, double height_m, double distance_m, double k);

/// Distance along the surface to the horizon for such light [m].
double horizon_distance_m(double earth_radius_m, double height_m, double k);

/// Altitude [rad] of a point above the eye's horizontal without air.
double geometric_altitude_rad(const NearRays &rays, double distance_m, double height_m);

/// One line of sight to a point of the target.
struct SightImage {
  double apparent_altitude_deg = 0;
  bool erect = true;             // higher points are seen higher
  double refraction_arcsec = 0;  // apparent less geometric altitude
  double k_of_refraction = 0;    // 2 R refraction/distance: what levelling instruments use
  double k_of_path = 0;          // whole bending times R/distance: mean curvature of the ray over the Earth's
};

struct SightLine {
  double distance_m = 0, target_height_m = 0;
  double geometric_altitude_deg = 0;  // of the top
  double hidden_m = 0;                // lowest height seen there, through this air
  double hidden_straight_m = 0;       // without air
  double hidden_k013_m = 0;           // with the surveyors' k = 0.13
  std::vector<SightImage> top, base;  // ascending; base: the lowest point that is above hidden_m
  double visible_m() const { return std::max(0.0, target_height_m - hidden_m); }
};

/* All lines of sight to a target that stands on the surface.
   breaks_rad: elevations at which what rays do jumps (sky_rays.hpp), empty where they are not known
   errors:     none; a target wholly hidden has no images
   method:     rays of 4096 elevations around it, ends of the visible part by halving, images by halving: each good to
               1e-12 rad. Images closer than some arc-second to each other are not told apart. */
SightLine sight_line(NearRays &rays, double distance_m, double target_height_m, const std::vector<double> &breaks_rad);

}  // namespace greenray
