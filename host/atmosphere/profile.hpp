// The profile manager's result: T, P, density and refractivity of the air at any height. G04 section 4.
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "atmosphere/profile_spec.hpp"
#include "atmosphere/refractivity.hpp"
#include "atmosphere/temperature_curve.hpp"

namespace greenray {

class Profile {
 public:
  /// Integrates the pressure. Throws InputError where the air is impossible (T <= 0) or varies along the surface (see
  /// air_section.hpp).
  explicit Profile(const ProfileSpec &spec);

  const ProfileSpec &spec() const { return spec_; }
  bool is_air() const { return spec_.index_levels.empty(); }
  /// Top of the medium above a sphere; a flat laboratory medium ends at its last row.
  double top_m(bool flat) const;

  /// State at a geometric height in 0..120 km, with derivatives by height. Throws std::domain_error below the ground.
  AirState air(double height_m) const;
  double density_kg_m3(double height_m) const;
  /// n-1 and d(n-1)/dh [1/m], exaggeration included.
  Dual refractivity(double height_m, double wavelength_nm) const;

  /// Where T', humidity or refractivity slopes jump, ascending, inside (0, top).
  const std::vector<double> &kinks_m() const { return kinks_m_; }
  const std::vector<double> &features_m() const { return curve_.features_m(); }

  /// Mass of air above a height [kg/m^2].
  double zenith_column_kg_m2(double height_m) const;

 private:
  Dual temperature_or_throw(double height_m) const;
  double relative_humidity(double height_m, double &slope) const;
  void find_kinks();
  void lay_panels();
  void integrate_pressure();
  double hydrostatic_rate(double height_m, double pressure_Pa) const;

  ProfileSpec spec_;
  TemperatureCurve curve_;
  std::vector<std::pair<double, LevelCurve>> humidity_;  // weight (1 but for a blend) and curve; dry ones are left out
  LevelCurve index_;
  std::vector<double> kinks_m_;
  std::vector<double> panel_m_, panel_ln_pressure_;  // quadrature panels: height of the lower end, ln P there
};

}  // namespace greenray
