// Where the Sun is, by date and place: ERFA does the astronomy.
#pragma once
#include "support/utc_time.hpp"

namespace greenray {

struct EarthPlace {
  double latitude_deg = 0, longitude_deg = 0;  // geodetic (WGS84), east positive
  double height_m = 0;                         // above the ellipsoid; sea level will do (100 m: 0.003 arcsec)
};

/// As seen from the place, without refraction.
struct SunSeen {
  double altitude_deg = 0, azimuth_deg = 0;  // above the horizontal plane; from north through east
  double distance_au = 1;
  double diameter_arcmin = 32;
};

/* Topocentric place of the Sun's centre: parallax, aberration, precession and nutation (IAU 2006/2000A) included.
   after_s: seconds after `time`. ut1_utc_s: UT1 - UTC [s], published by the IERS, within +-0.9; left at 0 it turns the
   sky by up to 13.5 arcsec. Polar motion (0.3 arcsec) is left out.
   errors: no such date, or outside 1961 to 2100, where UTC is defined well enough -> std::domain_error */
SunSeen sun_seen(const UtcTime &time, double after_s, const EarthPlace &place, double ut1_utc_s = 0);

}  // namespace greenray
