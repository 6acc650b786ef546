// A sky picture to be made: the keys of a scene file with their defaults, units in the names. No behaviour.
#pragma once
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "atmosphere/profile_spec.hpp"
#include "scene/moon_scene.hpp"
#include "scene/sweeps.hpp"
#include "scene/target_scene.hpp"
#include "scene/terrain_scene.hpp"

namespace greenray {

enum class Surface { sphere, flat };

struct AtmosphereScene {
  ProfileSpec profile;  // key `profile`: shipped name or file, relative to the scene file; loaded and checked
  std::string profile_source = "us76";  // as written
  Surface surface = Surface::sphere;    // key `surface`; `radius_km` overrides profile.earth_radius_m
  bool humidity = true;                 // false: relative humidity of the profile is ignored
  bool extinction = true;               // Rayleigh, ozone and aerosol along the bent path
  double ozone_DU = 300.0;
  std::optional<double> visibility_km;  // aerosol = { visibility_km | turbidity, angstrom, scale_height_m }
  std::optional<double> turbidity;      // (molecular + aerosol) / molecular vertical optical depth at 550 nm, >= 1
  double angstrom = 1.3;
  double aerosol_scale_height_m = 1200.0;
  double aerosol_asymmetry = 0.76;          // Henyey & Greenstein's g
  double aerosol_scattering_albedo = 0.97;  // of what it takes from the light, the share that is scattered
};

struct ObserverScene {
  double height_m = 2.0;
  double azimuth_deg = 270.0;  // from north through east
  double altitude_deg = 0.0;   // picture centre, apparent
  double fov_deg = 1.0;        // horizontal, < 180
  std::array<int, 2> resolution{400, 300};
};

struct SunScene {
  enum class Given { nothing, true_altitude, apparent_altitude } given = Given::nothing;
  enum class Part { centre, upper_limb, lower_limb } part = Part::centre;  // key `at`: which point has that altitude
  double altitude_deg = 0.0;
  SourcePlace altitude_place;
  std::optional<double> azimuth_deg;  // default: the observer's
  double diameter_arcmin = 31.9877;   // 2 x 959.63"
  bool by_date = false;               // keys `when` and `place` gave altitude, azimuth and diameter
  bool limb_darkening = true;
};

struct SkyScene {
  enum class Model {
    plain,
    academic
  } model = Model::plain;  // academic: black sky, white disk, no extinction (G04 figs 6.2, 6.3)
  enum class Surface { sea, land } surface = Surface::sea;
  double wind_m_s = 5.0;                  // raises the sea's waves
  std::optional<double> sea_reflectance;  // a mirror of the sky at 10 degrees in place of waves
  double ground_albedo = 0.06;            // lights the air from below; of land also what is seen. Default of land: 0.2
};

struct SeaScene {
  bool rough = false;                          // [sea] in the scene: waves roughen the horizon
  double wind_m_s = 0;                         // 10 m above the water
  std::optional<double> significant_height_m;  // of the waves; default: of a full-grown sea in that wind
};

struct SpectrumScene {
  std::array<double, 2> range_nm{390.0, 720.0};
  int samples = 24;  // spaced evenly in refractivity
};

struct TracingScene {
  enum class Method { automatic, rk45, richardson, cells } method = Method::automatic;
  enum class Transfer { table, per_pixel } transfer = Transfer::table;
  enum class Precision { automatic, single_, double_ } precision = Precision::automatic;
  enum class Dispersion { automatic, on, off } dispersion = Dispersion::automatic;  // off: all wavelengths bend as one
  double tolerance = 1e-9;      // local error of direction per step [rad]
  double table_arcsec = 0.003;  // error allowed to the index table
  int max_steps = 20000;
  std::optional<int> spp;  // quality = { spp | error_pct | minutes }
  std::optional<double> error_pct;
  std::optional<double> minutes;
};

struct EyeScene {
  enum class Model { human, camera, none } model = Model::camera;
  std::optional<double> exposure_ev;  // camera: stops on top of the automatic exposure
  // human, as the flags of `greenray develop` with the same names
  std::optional<double> bleaching_seconds;  // bleaching = { seconds | steady, model, pool }
  bool bleaching_steady = false;
  std::string bleaching_model = "catch", bleaching_pool = "pixel", pupil = "watson-yellott";
  bool glare = true, acuity = true, colour = true, sensitivity = true;
  double ldmax_cd_m2 = 100, contrast = 100, magnification = 1, age_years = 28.58;
};

struct OutputScene {
  std::string image;     // .exr; empty: out/<scene name>.exr
  bool spectral = true;  // write S0.<nm> channels
};

struct Scene {
  std::string name;  // file name without folder and extension
  std::string title;
  std::string file;                    // where it was read from
  std::string text;                    // the whole file, kept for the EXR header
  std::vector<std::string> overrides;  // -D KEY=VALUE, in order
  AtmosphereScene atmosphere;
  ObserverScene observer;
  SunScene sun;
  MoonScene moon;
  SkyScene sky;
  SeaScene sea;
  SpectrumScene spectrum;
  TracingScene tracing;
  EyeScene eye;
  OutputScene output;
  std::vector<TargetScene> targets;
  TerrainScene terrain;
  std::vector<SweepScene> sweeps;  // used by `greenray batch`
  std::vector<std::string> notes;  // warnings to print once
};

}  // namespace greenray
