#include "scene/ephemeris.hpp"

#include <erfa.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "support/angle.hpp"

namespace greenray {
namespace {

constexpr double day_s = 86400, light_s_per_au = 499.004784;        // IAU 2012 au, at the speed of light
constexpr double km_per_au = 149597870.7, moon_radius_km = 1737.4;  // IAU
constexpr double sun_semidiameter_arcsec = 959.63;                  // at 1 au (Auwers 1891, as almanacs use it)

using Vector = std::array<double, 3>;

Vector operator-(const Vector &a, const Vector &b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vector &a, const Vector &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double length(const Vector &a) { return std::sqrt(dot(a, a)); }
Vector times(const Vector &a, double f) { return {a[0] * f, a[1] * f, a[2] * f}; }

/// Barycentric places [au] at a moment of Barycentric Dynamical Time (Terrestrial Time will do).
Vector earth_barycentric_au(double tt1, double tt2) {
  double heliocentric[2][3], barycentric[2][3];
  eraEpv00(tt1, tt2, heliocentric, barycentric);
  return {barycentric[0][0], barycentric[0][1], barycentric[0][2]};
}
Vector sun_barycentric_au(double tt1, double tt2) {
  double heliocentric[2][3], barycentric[2][3];
  eraEpv00(tt1, tt2, heliocentric, barycentric);
  Vector sun{};
  for (std::size_t i = 0; i < 3; ++i) sun[i] = barycentric[0][i] - heliocentric[0][i];
  return sun;
}
Vector moon_geocentric_au(double tt1, double tt2) {
  double moon[2][3];
  eraMoon98(tt1, tt2, moon);
  return {moon[0][0], moon[0][1], moon[0][2]};
}
Vector moon_barycentric_au(double tt1, double tt2) {
  const Vector earth = earth_barycentric_au(tt1, tt2), moon = moon_geocentric_au(tt1, tt2);
  return {earth[0] + moon[0], earth[1] + moon[1], earth[2] + moon[2]};
}

/// From the observer to where a body was when its light left [au].
template <class Place>
Vector from_observer_au(double tt1, double tt2, const eraASTROM &observer, Place &&place) {
  double distance_au = 0;
  Vector to_body{};
  for (int round = 0; round < 3; ++round) {
    to_body =
        place(tt1, tt2 - distance_au * light_s_per_au / day_s) - Vector{observer.eb[0], observer.eb[1], observer.eb[2]};
    distance_au = length(to_body);
  }
  return to_body;
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

/// A moment at a place, as ERFA has it.
struct Moment {
  eraASTROM observer;
  double tt1, tt2;
};

Moment moment_of(const UtcTime &time, double after_s, const EarthPlace &place, double ut1_utc_s) {
  const auto [utc1, utc2] = julian_utc(time, after_s);
  Moment m{};
  double tai1 = 0, tai2 = 0, equation_of_origins = 0;
  eraUtctai(utc1, utc2, &tai1, &tai2);
  eraTaitt(tai1, tai2, &m.tt1, &m.tt2);
  constexpr double no_polar_motion = 0, no_air = 0, any_um = 0.55;
  eraApco13(utc1, utc2, ut1_utc_s, to_rad(place.longitude_deg), to_rad(place.latitude_deg), place.height_m,
            no_polar_motion, no_polar_motion, no_air, no_air, no_air, any_um, &m.observer, &equation_of_origins);
  return m;
}

/// Where a direction from the observer is seen: aberration, precession and nutation, the turning Earth.
struct Horizontal {
  double altitude_rad, azimuth_rad;
  /// East, north, up.
  Vector direction() const {
    return {std::cos(altitude_rad) * std::sin(azimuth_rad), std::cos(altitude_rad) * std::cos(azimuth_rad),
            std::sin(altitude_rad)};
  }
};

Horizontal seen_at(const Vector &to_body, Moment &m) {
  Vector natural = times(to_body, 1 / length(to_body));
  double proper[3], intermediate[3], right_ascension = 0, declination = 0;
  eraAb(natural.data(), m.observer.v, m.observer.em, m.observer.bm1, proper);
  eraRxp(m.observer.bpn, proper, intermediate);
  eraC2s(intermediate, &right_ascension, &declination);
  double azimuth = 0, zenith_distance = 0, hour_angle = 0, seen_declination = 0, seen_right_ascension = 0;
  eraAtioq(eraAnp(right_ascension), declination, &m.observer, &azimuth, &zenith_distance, &hour_angle,
           &seen_declination, &seen_right_ascension);
  return {pi / 2 - zenith_distance, azimuth};
}

/// Components of b as seen around a: to the right (growing azimuth) and up.
std::array<double, 2> beside(const Horizontal &a, const Horizontal &b) {
  const Vector there = b.direction(), right{std::cos(a.azimuth_rad), -std::sin(a.azimuth_rad), 0};
  const Vector up{-std::sin(a.altitude_rad) * std::sin(a.azimuth_rad),
                  -std::sin(a.altitude_rad) * std::cos(a.azimuth_rad), std::cos(a.altitude_rad)};
  return {dot(there, right), dot(there, up)};
}

}  // namespace

SunSeen sun_seen(const UtcTime &time, double after_s, const EarthPlace &place, double ut1_utc_s) {
  Moment m = moment_of(time, after_s, place, ut1_utc_s);
  const Vector to_sun = from_observer_au(m.tt1, m.tt2, m.observer, sun_barycentric_au);
  const double distance_au = length(to_sun);
  const Horizontal seen = seen_at(to_sun, m);
  return {to_deg(seen.altitude_rad), to_deg(seen.azimuth_rad), distance_au,
          2 * std::asin(std::sin(to_rad(sun_semidiameter_arcsec / 3600)) / distance_au) * 180 / pi * 60};
}

MoonSeen moon_seen(const UtcTime &time, double after_s, const EarthPlace &place, double ut1_utc_s) {
  Moment m = moment_of(time, after_s, place, ut1_utc_s);
  const Vector to_moon = from_observer_au(m.tt1, m.tt2, m.observer, moon_barycentric_au);
  const Vector to_sun = from_observer_au(m.tt1, m.tt2, m.observer, sun_barycentric_au);
  const double distance_au = length(to_moon);
  const Horizontal moon = seen_at(to_moon, m), sun = seen_at(to_sun, m);
  MoonSeen seen;
  seen.altitude_deg = to_deg(moon.altitude_rad), seen.azimuth_deg = to_deg(moon.azimuth_rad);
  seen.distance_km = distance_au * km_per_au;
  seen.diameter_arcmin = 2 * to_deg(std::asin(moon_radius_km / seen.distance_km)) * 60;
  const Vector moon_to_sun = to_sun - to_moon;
  seen.sun_distance_au = length(moon_to_sun);
  const double cosine = -dot(to_moon, moon_to_sun) / (distance_au * seen.sun_distance_au);
  seen.phase_angle_deg = to_deg(std::acos(std::clamp(cosine, -1.0, 1.0)));
  const std::array<double, 2> towards_sun = beside(moon, sun);
  seen.bright_limb_deg = to_deg(std::atan2(towards_sun[0], towards_sun[1]));
  // The shadow's axis at the Moon's distance: opposite to the Sun as seen from the Earth's centre.
  const Vector earth = earth_barycentric_au(m.tt1, m.tt2);
  const Vector sun_of_earth = sun_barycentric_au(m.tt1, m.tt2 - light_s_per_au / day_s) - earth;
  const Vector centre = times(sun_of_earth, -length(moon_geocentric_au(m.tt1, m.tt2)) / length(sun_of_earth));
  const Vector observer{m.observer.eb[0] - earth[0], m.observer.eb[1] - earth[1], m.observer.eb[2] - earth[2]};
  const Horizontal axis = seen_at(centre - observer, m);
  for (std::size_t i = 0; i < 2; ++i) seen.shadow_arcmin[i] = 60 * to_deg(beside(moon, axis)[i]);
  seen.shadow_ahead = dot(moon.direction(), axis.direction()) > 0;
  return seen;
}

}  // namespace greenray
