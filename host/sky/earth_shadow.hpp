// The Earth's shadow at the Moon: sunlight bent and reddened by the air of the Earth's limb.
#pragma once
#include <vector>

#include "sky/optics.hpp"

namespace greenray {

/* Irradiance behind the Earth, over that beyond its shadow, by the distance from the shadow's axis. Every ring of light
   that passes the limb at a height is dimmed by the air it grazes, turned by twice the bending from its lowest point
   outward, and laid down as a ring in the plane of the Moon; the Sun's disk (linear limb darkening 0.6) smears it.
   Light is conserved ring by ring, so nothing is infinite where rings cross the axis. One formula from the umbra to the
   open. After Link 1962 (Lunar Eclipses, in Physics and Astronomy of the Moon), who sums images instead. Not modelled:
   light that air scatters into the shadow (Garcia Munoz & Palle 2011: it matters in the blue deep inside), clouds and
   mountains at the limb, the Earth's flattening. */
class EarthShadow {
 public:
  /// shells: over a sphere, from the ground. sun_radius_rad: as seen from there.
  EarthShadow(const AirShells &shells, const SkyOptics &optics, double sun_radius_rad, double distance_m = 384.4e6,
              double sun_distance_m = 149.6e9);

  /// A ray that passes the limb with its lowest point at a height.
  struct Graze {
    double height_m, impact_m, bending_rad;  // impact: from the Earth's centre to the ray's asymptotes
    Columns column;
  };
  const std::vector<Graze> &grazes() const { return grazes_; }

  double step_m() const { return step_m_; }  // between rows, from the axis outward; beyond the last all light is there
  std::size_t rows() const { return share_.size() / padded_; }
  const float *row(std::size_t i) const { return &share_[i * padded_]; }
  std::size_t padded() const { return padded_; }
  /// Fills share[w] at a distance from the axis, w < padded.
  void share(double from_axis_m, float *share) const;

 private:
  void add_ring(double radius_m, const std::vector<float> &flux, double disk_m);

  std::size_t padded_;
  double step_m_ = 100e3;
  std::vector<Graze> grazes_;
  std::vector<float> share_;  // [rows][padded]
};

}  // namespace greenray
