// Places along geodesics of the WGS84 ellipsoid.
#pragma once
#include <vector>

namespace greenray {

/// Geodetic, WGS84; east positive.
struct GeoPlace {
  double latitude_deg = 0, longitude_deg = 0;
};

/* The place `distance_m` away along the geodesic that leaves `from` at an azimuth from north through east.
   errors: of the place below 1 mm up to 1000 km
   source: Vincenty, Survey Review 23 (1975) 88, direct formula */
GeoPlace geodesic_place(const GeoPlace &from, double azimuth_rad, double distance_m);

/// One geodesic looked up many times: knots 1 km apart, between them a straight line in latitude and longitude (3 cm
/// times the tangent of the latitude at most).
class GeodesicLine {
 public:
  GeodesicLine(const GeoPlace &from, double azimuth_rad, double farthest_m);
  /// distance_m: 0 to farthest_m
  GeoPlace at(double distance_m) const;

 private:
  std::vector<GeoPlace> knots_;
};

}  // namespace greenray
