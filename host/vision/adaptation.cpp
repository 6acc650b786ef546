#include "vision/adaptation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace greenray::vision {

std::array<int, 2> foveal_size(const ViewGeometry &view) {
  constexpr double deg = std::numbers::pi / 180, sun_radius_deg = 0.2666;
  const double cell = (view.fov_deg < 5 ? sun_radius_deg : 1.0) * deg;
  return {std::max(2, static_cast<int>(std::lround(2 * view.half_width / cell))),
          std::max(2, static_cast<int>(std::lround(2 * view.half_height / cell)))};
}

Plane foveal_samples(const Plane &cells, const ViewGeometry &view) {
  const std::array<int, 2> wanted = foveal_size(view);
  Plane samples(std::min(wanted[0], cells.width), std::min(wanted[1], cells.height));
  for (int y = 0; y < samples.height; ++y)
    for (int x = 0; x < samples.width; ++x) {
      const auto from = [](int i, int size, int count) {
        return static_cast<int>(static_cast<long long>(i) * size / count);
      };
      double sum = 0;
      int count = 0;
      for (int cy = from(y, cells.height, samples.height); cy < from(y + 1, cells.height, samples.height); ++cy)
        for (int cx = from(x, cells.width, samples.width); cx < from(x + 1, cells.width, samples.width); ++cx, ++count)
          sum += static_cast<double>(cells.row(cy)[cx]);
      samples.row(y)[x] = static_cast<float>(sum / count);
    }
  return samples;
}

PupilField pupil_field(const ViewGeometry &view, double mean_cd_m2, double surround_cd_m2, const EyeOptions &options) {
  constexpr double least_field_deg2 = 60;
  const double picture_deg2 = view.area_deg2(), field_deg2 = std::max(picture_deg2, least_field_deg2);
  const double flux = mean_cd_m2 * picture_deg2 + surround_cd_m2 * (field_deg2 - picture_deg2);
  return {flux / field_deg2, field_deg2, options.eye.age_years, options.eyes};
}

}  // namespace greenray::vision
