// The sea as a mirror of the sky: Fresnel's reflection averaged over the slopes of waves.
#pragma once
#include <vector>

#include "sky/sky_field.hpp"

namespace greenray {

/// Reflectance of smooth water (index 1.34) for unpolarised light, by the cosine of the angle of incidence.
double fresnel_water(double cosine);

/// Mean square slope of waves, both directions together, by the wind at 41 feet (Cox & Munk 1954): 0.003 + 0.00512 W.
double mean_square_slope(double wind_m_s);

/* Radiance of a sea under a clear sky, for light of irradiance 1 outside the air: the sky and the Sun mirrored in
   facets whose slopes are Gaussian and alike in all directions, weighed by how much of each facet is seen. A fixed
   reflectance mirrors the sky at 10 degrees instead. Not modelled: light from within the water, foam, facets hidden
   behind others, second reflections (a facet that mirrors the sea shows the sky at the horizon). */
class Sea {
 public:
  /// sun_altitudes_rad: those for which the sky above the sea is worked out; between them it is interpolated.
  Sea(const SkyField &field, std::vector<double> sun_altitudes_rad, double wind_m_s, double fixed_reflectance = -1);

  /// Adds the sky's light that a line of sight which ends on the sea receives from there, [padded].
  void add(const ScatterPath &path, const SunOfStart &sun, float *radiance) const;

  /// The Sun's: radiance = strength[w] x reflectance x density of the slope that mirrors it / cos^4 of its tilt (Cox &
  /// Munk 1954), both for the kernel to find (kernels/sky/sky.h, glitter). Sines of the line of sight's and the Sun's
  /// altitude at the sea.
  struct Glitter {
    double grazing, sun;
    std::vector<float> strength;  // [padded]; all 0: none
  };
  Glitter glitter(const ScatterPath &path, const SunOfStart &sun) const;
  bool has_waves() const { return fixed_reflectance_ < 0; }
  double slope2() const { return slope2_; }

 private:
  void add_sky(double sun_altitude_rad, double elevation_rad, double azimuth_rad, float weight, float *light) const;
  double facets_seen(double grazing_rad) const;
  void mirror(double sun_altitude_rad, double grazing_rad, double azimuth_rad, float *light) const;

  const SkyField &field_;
  double slope2_, fixed_reflectance_;
  std::vector<double> sun_rad_;
  Axis elevation_rad_, azimuth_rad_;
  std::vector<float> dome_;  // [suns][elevations][azimuths][padded]
};

}  // namespace greenray
