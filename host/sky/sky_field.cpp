#include "sky/sky_field.hpp"

#include <algorithm>
#include <cmath>

namespace greenray {
namespace {

std::vector<double> marks_of(const LayeredMedium &medium) {
  constexpr std::size_t most = 150;  // more would cost time and add nothing that the sky shows
  std::vector<double> marks = medium.kinks_m;
  marks.insert(marks.end(), medium.features_m.begin(), medium.features_m.end());
  std::sort(marks.begin(), marks.end());
  if (marks.size() <= most) return marks;
  std::vector<double> fewer;
  for (std::size_t i = 0; i < most; ++i) fewer.push_back(marks[i * marks.size() / most]);
  return fewer;
}

std::size_t level_at(const AirShells &shells, double height_m) {
  for (std::size_t k = 0; k < shells.levels(); ++k)
    if (shells.height_m(k) >= height_m) return k;
  return shells.levels() - 1;
}

}  // namespace

SkyField::SkyField(const LayeredMedium &medium, const LayerAbsorbers &absorbers, SkyOptics optics,
                   const SkyFieldOptions &options)
    : options_(options),
      optics_(std::move(optics)),
      shells_(medium, options.wavelength_nm, absorbers,
              shell_heights(medium, marks_of(medium), options.eye_m, options.step)),
      eye_(level_at(shells_, options.eye_m)),
      sunlight_(shells_, optics_, options.sun_radius_rad),
      diffuse_(medium, options.wavelength_nm, absorbers, optics_, sunlight_, options.ground_albedo) {}

ScatterPath SkyField::line_of_sight(double elevation_rad, double longest_m) const {
  return scatter_path(shells_, optics_, sunlight_, diffuse_, shells_.path(eye_, elevation_rad, longest_m),
                      elevation_rad);
}

Airlight SkyField::airlight(double elevation_rad, double distance_m, double sun_altitude_rad, double cos_azimuth,
                            std::span<const double> irradiance) const {
  const ScatterPath path = line_of_sight(elevation_rad, distance_m);
  std::vector<float> radiance(optics_.padded(), 0.0f);
  add_scattered(path, optics_, {&sunlight_, &diffuse_, 0}, sun_altitude_rad, cos_azimuth, radiance.data());
  Airlight light;
  for (std::size_t w = 0; w < optics_.waves(); ++w) {
    light.radiance.push_back(radiance[w] * static_cast<float>(irradiance[w]));
    light.transmittance.push_back(path.transmittance[w]);
  }
  return light;
}

}  // namespace greenray
