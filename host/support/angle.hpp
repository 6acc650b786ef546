// Degrees, arc-seconds, radians.
#pragma once
#include <cmath>

namespace greenray {

constexpr double pi = 3.14159265358979323846;
constexpr double to_rad(double deg) { return deg * (pi / 180); }
constexpr double to_deg(double rad) { return rad * (180 / pi); }
constexpr double from_arcsec(double arcsec) { return arcsec * (pi / 648000); }
constexpr double to_arcsec(double rad) { return rad * (648000 / pi); }

}  // namespace greenray
