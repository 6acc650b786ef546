// Skies for tests: fields of known coefficients, luminance and illuminance of a clear day.
#pragma once
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "atmosphere/profile.hpp"
#include "render/sky_glow.hpp"
#include "support/angle.hpp"
#include "support/csv_table.hpp"

namespace greenray::testing_data {

/// Optics of a few wavelengths, padded.
inline SkyOptics test_optics(const std::vector<double> &rayleigh, const std::vector<double> &ozone,
                             const std::vector<double> &aerosol, double anisotropy, double albedo, double asymmetry) {
  SkyOptics o;
  o.wavelength_nm.assign(rayleigh.size(), 550);
  o.aerosol_albedo = albedo;
  o.aerosol_asymmetry = asymmetry;
  const RayleighPhase phase = rayleigh_phase(anisotropy);
  for (std::size_t w = 0; w < (rayleigh.size() + spectral_group - 1) / spectral_group * spectral_group; ++w) {
    const std::size_t at = std::min(w, rayleigh.size() - 1);
    o.rayleigh_per_kg_m2.push_back(static_cast<float>(rayleigh[at]));
    o.ozone_per_m.push_back(static_cast<float>(ozone[at]));
    o.aerosol_per_m.push_back(static_cast<float>(aerosol[at]));
    o.rayleigh_even.push_back(static_cast<float>(phase.even));
    o.rayleigh_square.push_back(static_cast<float>(phase.square));
  }
  return o;
}

/// The sky over US76 for an eye at sea level, in photometric units.
class ClearDay {
 public:
  explicit ClearDay(double visibility_km, double ozone_DU = 300) {
    scene_.atmosphere.visibility_km = visibility_km;
    scene_.atmosphere.ozone_DU = ozone_DU;
    const CsvTable observer = CsvTable::embedded("host/data/cie1931_2deg_xyz_5nm.csv");
    for (double nm = 390; nm <= 720; nm += 10) nm_.push_back(nm);
    const std::vector<SpectralAir> air = spectral_air(scene_, nm_);
    for (std::size_t w = 0; w < nm_.size(); ++w)
      for (std::size_t k = 0; k < 3; ++k)
        per_irradiance_[k].push_back(683 * 10 * air[w].irradiance_outside(from_arcsec(959.63)) *
                                     observer.interpolate("nm", std::string(1, "xyz"[k]), nm_[w]));
    field_ = sky_field(scene_, Profile(ProfileSpec{}), air, nm_);
  }
  /// Tristimulus values of a spectrum per irradiance outside the air; the second is in cd/m2 or lx.
  std::array<double, 3> tristimulus(const std::vector<float> &spectrum) const {
    std::array<double, 3> xyz{};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t w = 0; w < nm_.size(); ++w) xyz[k] += per_irradiance_[k][w] * spectrum[w];
    return xyz;
  }
  std::array<double, 3> sky(double sun_deg, double elevation_deg, double azimuth_deg,
                            bool further_orders = true) const {
    std::vector<float> light(field_->optics().padded(), 0.0f);
    add_scattered(field_->line_of_sight(to_rad(elevation_deg)), field_->optics(),
                  {&field_->sunlight(), further_orders ? &field_->diffuse() : nullptr, 0}, to_rad(sun_deg),
                  std::cos(to_rad(azimuth_deg)), light.data());
    return tristimulus(light);
  }
  double outside_lx() const { return tristimulus(std::vector<float>(nm_.size(), 1.0f))[1]; }
  double zenith_cd_m2(double sun_deg) const { return sky(sun_deg, 90, 0)[1]; }
  double direct_normal_lx(double sun_deg) const {
    std::vector<float> light(field_->optics().padded());
    field_->sunlight().share(0, to_rad(sun_deg), light.data());
    return tristimulus(light)[1];
  }
  /// On level ground, Sun and sky.
  double illuminance_lx(double sun_deg) const {
    std::vector<float> sky(field_->optics().padded());
    field_->diffuse().irradiance(to_rad(sun_deg), sky.data());
    const double seen = to_rad(sun_deg) + field_->sunlight().look(0, to_rad(sun_deg)).lift_rad;
    return tristimulus(sky)[1] + direct_normal_lx(sun_deg) * std::max(0.0, std::sin(seen));
  }
  const SkyField &field() const { return *field_; }

 private:
  Scene scene_;
  std::vector<double> nm_;
  std::array<std::vector<double>, 3> per_irradiance_;
  std::shared_ptr<const SkyField> field_;
};

}  // namespace greenray::testing_data
