#include "scene/ephemeris.hpp"

#include <erfa.h>

#include <array>
#include <cmath>
#include <stdexcept>

#include "support/angle.hpp"

namespace greenray {
namespace {

constexpr double day_s = 86400, light_s_per_au = 499.004784;  // IAU 2012 au, at the speed of light
constexpr double sun_semidiameter_arcsec = 959.63;            // at 1 au (Auwers 1891, as almanacs use it)

/// Barycentric place of the Sun [au] at a moment of Barycentric Dynamical Time (Terrestrial Time will do).
std::array<double, 3> sun_barycentric_au(double tt1, double tt2) {
  double heliocentric[2][3], barycentric[2][3];
  eraEpv00(tt1, tt2, heliocentric, barycentric);
  std::array<double, 3> sun{};
  for (std::size_t i = 0; i < 3; ++i) sun[i] = barycentric[0][i] - heliocentric[0][i];
  return sun;
}

/// From the observer to where the Sun was when its light left [au].
std::array<double, 3> sun_from_observer_au(double tt1, double tt2, const eraASTROM &observer) {
  double distance_au = 1;
  std::array<double, 3> to_sun{};
  for (int round = 0; round < 2; ++round) {
    const std::array<double, 3> sun = sun_barycentric_au(tt1, tt2 - distance_au * light_s_per_au / day_s);
    for (std::size_t i = 0; i < 3; ++i) to_sun[i] = sun[i] - observer.eb[i];
    distance_au = std::hypot(to_sun[0], to_sun[1], to_sun[2]);
  }
  return to_sun;
}

/// UTC as ERFA wants it: two parts of a Julian date whose days are a second longer where a leap second is.
std::array<double, 2> julian_utc(const UtcTime &time, double after_s) {
  double day = 0, fraction = 0;
  const int status =
      eraDtf2d("UTC", time.year, time.month, time.day, time.hour, time.minute, time.second, &day, &fraction);
  if (status < 0 || time.year < 1961 || time.year > 2100)
    throw std::domain_error("expected a moment that there is, from 1961 to 2100");
  return {day, fraction + after_s / day_s};
}

}  // namespace

SunSeen sun_seen(const UtcTime &time, double after_s, const EarthPlace &place, double ut1_utc_s) {
  const auto [utc1, utc2] = julian_utc(time, after_s);
  double tai1 = 0, tai2 = 0, tt1 = 0, tt2 = 0, equation_of_origins = 0;
  eraUtctai(utc1, utc2, &tai1, &tai2);
  eraTaitt(tai1, tai2, &tt1, &tt2);
  eraASTROM observer;
  constexpr double no_polar_motion = 0, no_air = 0, any_um = 0.55;
  eraApco13(utc1, utc2, ut1_utc_s, to_rad(place.longitude_deg), to_rad(place.latitude_deg), place.height_m,
            no_polar_motion, no_polar_motion, no_air, no_air, no_air, any_um, &observer, &equation_of_origins);

  const std::array<double, 3> to_sun = sun_from_observer_au(tt1, tt2, observer);
  const double distance_au = std::hypot(to_sun[0], to_sun[1], to_sun[2]);
  double natural[3], proper[3], intermediate[3], right_ascension = 0, declination = 0;
  for (std::size_t i = 0; i < 3; ++i) natural[i] = to_sun[i] / distance_au;
  eraAb(natural, observer.v, observer.em, observer.bm1, proper);
  eraRxp(observer.bpn, proper, intermediate);
  eraC2s(intermediate, &right_ascension, &declination);

  double azimuth = 0, zenith_distance = 0, hour_angle = 0, seen_declination = 0, seen_right_ascension = 0;
  eraAtioq(eraAnp(right_ascension), declination, &observer, &azimuth, &zenith_distance, &hour_angle, &seen_declination,
           &seen_right_ascension);
  return {90 - to_deg(zenith_distance), to_deg(azimuth), distance_au,
          2 * std::asin(std::sin(to_rad(sun_semidiameter_arcsec / 3600)) / distance_au) * 180 / pi * 60};
}

}  // namespace greenray
