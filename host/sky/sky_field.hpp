// The light of the whole sky as one eye sees it: paths, sunlight and diffuse light together.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "sky/scatter.hpp"

namespace greenray {

struct SkyFieldOptions {
  double eye_m = 0;
  double sun_radius_rad = 959.63 / 3600 * 3.14159265358979323846 / 180;
  double ground_albedo = 0.06;  // Lambertian, what lights the air from below; 0.06: the sea
  double wavelength_nm = 550;   // whose refraction all light has here
  double step = 0.12;           // of the shells (shell_heights)
};

/// Light that a piece of path adds to what is seen behind it, and what it leaves of that.
struct Airlight {
  std::vector<float> radiance;       // [wavelengths], W m^-2 sr^-1 nm^-1
  std::vector<float> transmittance;  // [wavelengths]
};

/* Radiance of clear air in the light of the Sun, for every elevation, azimuth and altitude of the Sun:
     single scattering along the bent line of sight by air (Rayleigh, depolarised) and aerosol (Henyey & Greenstein), of
     sunlight as `Sunlight` has it, and all further orders as `DiffuseLight` has them.
   Air varies with height alone. Nothing here depends on where the Sun is: a film shares it. */
class SkyField {
 public:
  SkyField(const LayeredMedium &medium, const LayerAbsorbers &absorbers, SkyOptics optics,
           const SkyFieldOptions &options);

  const AirShells &shells() const { return shells_; }
  const SkyOptics &optics() const { return optics_; }
  const Sunlight &sunlight() const { return sunlight_; }
  const DiffuseLight &diffuse() const { return diffuse_; }
  std::size_t eye_level() const { return eye_; }
  double ground_albedo() const { return options_.ground_albedo; }
  SkySources sources() const { return {&sunlight_, &diffuse_, options_.ground_albedo}; }

  /// The eye's line of sight at an elevation [rad]; longest_m: its length along the path.
  ScatterPath line_of_sight(double elevation_rad, double longest_m = 1e9) const;

  /// What the air between the eye and a place at distance_m along the line of sight adds to the radiance of that
  /// place, and its transmittance. irradiance: of the Sun outside the air, [wavelengths], W m^-2 nm^-1.
  /// cos_azimuth: of the angle between the azimuths of Sun and line of sight. The target itself casts no shadow.
  Airlight airlight(double elevation_rad, double distance_m, double sun_altitude_rad, double cos_azimuth,
                    std::span<const double> irradiance) const;

 private:
  SkyFieldOptions options_;
  SkyOptics optics_;
  AirShells shells_;
  std::size_t eye_;
  Sunlight sunlight_;
  DiffuseLight diffuse_;
};

}  // namespace greenray
