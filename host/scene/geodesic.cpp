#include "scene/geodesic.hpp"

#include <algorithm>
#include <cmath>

#include "support/angle.hpp"

namespace greenray {
namespace {
constexpr double semi_major_m = 6378137.0, flattening = 1 / 298.257223563;  // WGS84
constexpr double semi_minor_m = semi_major_m * (1 - flattening);
constexpr double knot_m = 1000;
}  // namespace

GeoPlace geodesic_place(const GeoPlace &from, double azimuth_rad, double distance_m) {
  const double sin_azimuth = std::sin(azimuth_rad), cos_azimuth = std::cos(azimuth_rad);
  const double tan_u1 = (1 - flattening) * std::tan(to_rad(from.latitude_deg));
  const double cos_u1 = 1 / std::hypot(1, tan_u1), sin_u1 = tan_u1 * cos_u1;
  const double sigma1 = std::atan2(tan_u1, cos_azimuth), sin_alpha = cos_u1 * sin_azimuth;
  const double cos2_alpha = 1 - sin_alpha * sin_alpha;
  const double u2 = cos2_alpha * (semi_major_m * semi_major_m / (semi_minor_m * semi_minor_m) - 1);
  const double a = 1 + u2 / 16384 * (4096 + u2 * (-768 + u2 * (320 - 175 * u2)));
  const double b = u2 / 1024 * (256 + u2 * (-128 + u2 * (74 - 47 * u2)));
  const double straight = distance_m / (semi_minor_m * a);
  double sigma = straight, middle = 0;
  for (int round = 0; round < 6; ++round) {
    middle = std::cos(2 * sigma1 + sigma);
    const double s = std::sin(sigma), c = std::cos(sigma), m2 = middle * middle;
    sigma = straight + b * s * (middle + b / 4 * (c * (2 * m2 - 1) - b / 6 * middle * (4 * s * s - 3) * (4 * m2 - 3)));
  }
  middle = std::cos(2 * sigma1 + sigma);
  const double s = std::sin(sigma), c = std::cos(sigma);
  const double across = sin_u1 * s - cos_u1 * c * cos_azimuth;
  const double latitude =
      std::atan2(sin_u1 * c + cos_u1 * s * cos_azimuth, (1 - flattening) * std::hypot(sin_alpha, across));
  const double lambda = std::atan2(s * sin_azimuth, cos_u1 * c - sin_u1 * s * cos_azimuth);
  const double k = flattening / 16 * cos2_alpha * (4 + flattening * (4 - 3 * cos2_alpha));
  const double longitude =
      lambda - (1 - k) * flattening * sin_alpha * (sigma + k * s * (middle + k * c * (2 * middle * middle - 1)));
  return {to_deg(latitude), from.longitude_deg + to_deg(longitude)};
}

GeodesicLine::GeodesicLine(const GeoPlace &from, double azimuth_rad, double farthest_m) {
  const auto count = static_cast<std::size_t>(farthest_m / knot_m) + 2;
  for (std::size_t i = 0; i < count; ++i)
    knots_.push_back(geodesic_place(from, azimuth_rad, knot_m * static_cast<double>(i)));
}

GeoPlace GeodesicLine::at(double distance_m) const {
  const double place = distance_m / knot_m;
  const std::size_t low = std::min(static_cast<std::size_t>(place), knots_.size() - 2);
  const double f = place - static_cast<double>(low);
  const GeoPlace &a = knots_[low], &b = knots_[low + 1];
  return {a.latitude_deg + f * (b.latitude_deg - a.latitude_deg),
          a.longitude_deg + f * (b.longitude_deg - a.longitude_deg)};
}

}  // namespace greenray
