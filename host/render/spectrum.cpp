#include "render/spectrum.hpp"

#include <cmath>

#include "atmosphere/refractivity.hpp"
#include "atmosphere/standard_atmosphere.hpp"
#include "support/angle.hpp"
#include "support/csv_table.hpp"

namespace greenray {
namespace {

constexpr double avogadro_per_kmol = 6.02214076e26;
constexpr double molecules_per_m2_per_DU = 2.687e20;
constexpr double surface_air_kg_m3 = 1.225;  // US76
constexpr double koschmieder = 3.912;        // -ln(0.02)
constexpr double reference_nm = 550;

using Outside = CsvTable::Outside;

double rayleigh_per_kg_m2(const CsvTable &table, double wavelength_nm) {
  const double cross_section_m2 = 1e-4 * table.interpolate("nm", "sigma_bodhaine_cm2", wavelength_nm, Outside::clamp);
  return cross_section_m2 * avogadro_per_kmol / us76::molar_mass_kg_kmol;
}

/// Extinction of the aerosol at the surface at 550 nm [1/m].
double aerosol_at_reference(const AtmosphereScene &air, double rayleigh_kg) {
  if (air.visibility_km)
    return std::max(0.0, koschmieder / (*air.visibility_km * 1e3) - rayleigh_kg * surface_air_kg_m3);
  if (air.turbidity) {
    const double molecular_depth = rayleigh_kg * 101325.0 / us76::gravity_m_s2;
    return (*air.turbidity - 1) * molecular_depth / air.aerosol_scale_height_m;
  }
  return 0;
}

/// Coefficients between the rows of Neckel & Labs; constant outside. They sum to 1 again after interpolation.
std::array<double, 6> limb_darkening(const CsvTable &table, double wavelength_nm) {
  std::array<double, 6> a{};
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    sum += a[k] = table.interpolate("nm", "A" + std::to_string(k), wavelength_nm, Outside::clamp);
  for (double &x : a) x /= sum;
  return a;
}

/// A disk that a display shows white: the spectrum of D65, as bright as the Sun at 560 nm (2.6e4 W m^-2 sr^-1 nm^-1).
SpectralAir academic_air(const CsvTable &d65, double wavelength_nm) {
  SpectralAir air{};
  air.limb = {1, 0, 0, 0, 0, 0};
  air.sun_centre_radiance = 2.6e4 * d65.interpolate("nm", "S", wavelength_nm, Outside::clamp) / 100;
  return air;
}

}  // namespace

double SpectralAir::limb_mean() const {
  double mean = 0;
  for (std::size_t k = 0; k < limb.size(); ++k) mean += 2 * limb[k] / static_cast<double>(k + 2);
  return mean;
}

double SpectralAir::irradiance_outside(double radius_rad) const {
  return sun_centre_radiance * limb_mean() * pi * radius_rad * radius_rad;
}

std::vector<double> wavelengths_even_in_refraction(IndexModel model, const std::array<double, 2> &range_nm,
                                                   int samples) {
  if (samples == 1) return {0.5 * (range_nm[0] + range_nm[1])};
  const double n_short = reference_refractivity(model, range_nm[0]),
               n_long = reference_refractivity(model, range_nm[1]);
  std::vector<double> wavelengths;
  for (int i = 0; i < samples; ++i) {
    const double wanted = n_short + (n_long - n_short) * i / (samples - 1);
    double low = range_nm[0], high = range_nm[1];
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (reference_refractivity(model, middle) > wanted ? low : high) = middle;
    }
    wavelengths.push_back(0.5 * (low + high));
  }
  wavelengths.front() = range_nm[0];
  wavelengths.back() = range_nm[1];
  return wavelengths;
}

std::vector<SpectralAir> spectral_air(const Scene &scene, const std::vector<double> &wavelength_nm) {
  if (scene.sky.model == SkyScene::Model::academic) {
    const CsvTable d65 = CsvTable::embedded("host/data/cie_d65_5nm.csv");
    std::vector<SpectralAir> white;
    for (double nm : wavelength_nm) white.push_back(academic_air(d65, nm));
    return white;
  }
  const CsvTable sun = CsvTable::embedded("host/data/solar_extraterrestrial_5nm.csv");
  const CsvTable limb = CsvTable::embedded("host/data/limb_darkening_neckel_labs1994.csv");
  const CsvTable rayleigh = CsvTable::embedded("host/data/rayleigh_5nm.csv");
  const CsvTable ozone = CsvTable::embedded("host/data/ozone_chappuis_xsec_10nm.csv");
  const double radius_rad = from_arcsec(mean_sun_radius_arcsec), disk_sr = pi * radius_rad * radius_rad;
  const AtmosphereScene &air = scene.atmosphere;
  const double aerosol_m = aerosol_at_reference(air, rayleigh_per_kg_m2(rayleigh, reference_nm));

  std::vector<SpectralAir> all;
  for (double nm : wavelength_nm) {
    SpectralAir a{};
    a.limb = scene.sun.limb_darkening ? limb_darkening(limb, nm) : std::array<double, 6>{1, 0, 0, 0, 0, 0};
    a.sun_centre_radiance = sun.interpolate("nm", "E490", nm, Outside::clamp) / disk_sr / a.limb_mean();
    if (air.extinction) {
      a.rayleigh_per_kg_m2 = rayleigh_per_kg_m2(rayleigh, nm);
      const double column = air.ozone_DU * molecules_per_m2_per_DU / (ozone_width_m * std::sqrt(2 * pi));
      a.ozone_per_m = column * ozone.interpolate("nm_centre", "sigma_m2", nm, Outside::clamp);
      a.aerosol_per_m = aerosol_m * std::pow(nm / reference_nm, -air.angstrom);
    }
    all.push_back(a);
  }
  return all;
}

}  // namespace greenray
