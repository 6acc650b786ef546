// Where the Sun is, by date and place: ERFA does the astronomy.
#pragma once
#include <array>

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

/// The Moon as seen from the place, without refraction.
struct MoonSeen {
  double altitude_deg = 0, azimuth_deg = 0;
  double distance_km = 384400;
  double diameter_arcmin = 31.09;
  double phase_angle_deg = 0;  // between Sun and observer, seen from the Moon
  double bright_limb_deg = 0;  // where the Sun stands, from the top of the disk clockwise
  double sun_distance_au = 1;  // from the Moon
  /// Axis of the Earth's shadow at the Moon's distance, from the Moon's centre to the right and up; of use while the
  /// two are near each other.
  std::array<double, 2> shadow_arcmin{};
  bool shadow_ahead = false;  // in the Moon's half of the sky at all
};

/* Topocentric place of the Moon (eraMoon98 after Meeus 1998: some arc-seconds), its phase and the Earth's shadow. As
   sun_seen. */
MoonSeen moon_seen(const UtcTime &time, double after_s, const EarthPlace &place, double ut1_utc_s = 0);

}  // namespace greenray
