// A scene with surfaces: the keys of its file with their defaults, units in the names, everything in world coordinates.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "atmosphere/profile_spec.hpp"
#include "scene/scene.hpp"
#include "scene/surfaces.hpp"

namespace greenray {

/// How something depends on wavelength: linear Rec. 709 in 0..1 for reflectances, a shape for lights.
struct Colour {
  enum class Kind { grey, rgb, blackbody } kind = Kind::grey;
  std::array<double, 3> rgb{1, 1, 1};  // grey: three times the same
  double temperature_K = 6500;
};

/// n(wavelength in um): cauchy  A + B/l^2 + C/l^4;  sellmeier  n^2 = 1 + sum B l^2/(l^2 - C), C in um^2.
struct GlassIndex {
  enum class Kind { constant, cauchy, sellmeier } kind = Kind::constant;
  std::vector<double> b{1.5}, c_um2;
  double at(double wavelength_nm) const;
  bool disperses() const { return kind != Kind::constant; }
};

struct MaterialScene {
  enum class Kind { lambert, mirror, dielectric, rough_conductor, rough_dielectric } kind = Kind::lambert;
  std::string name;
  Colour reflectance;          // lambert: albedo; mirror, conductors: tint of what they reflect
  std::optional<int> texture;  // index into RoomScene::textures; replaces reflectance
  GlassIndex index;            // dielectrics: n
  std::array<double, 3> conductor_n{0.2, 0.92, 1.1}, conductor_k{3.9, 2.45, 2.45};  // at 630, 532, 465 nm: gold
  double roughness = 0.1;                                                           // alpha of GGX
  double absorption_per_m = 0;                                                      // inside a dielectric
  SourcePlace place;
};

struct TextureScene {
  std::string path;  // as found; embedded files keep their name
  SourcePlace place;
};

struct LightScene {
  enum class Kind { point, spot, area, sun } kind = Kind::point;
  Triple from{}, direction{0, 0, -1};  // direction: of travel, unit
  double cone_deg = 0;                 // spot: full angle of its even cone
  double power_W = 0;                  // over the scene's range of wavelengths; sun: irradiance instead
  double irradiance_W_m2 = 0;          // sun: on a surface that faces it
  double diameter_deg = 0.533;         // sun
  double photon_weight = 1;            // its share of the photons is its power times this
  Colour colour;
  SourcePlace place;
  // sun
  double altitude_deg = 45, azimuth_deg = 180;  // of its centre; where it stands, from north (+y) through east (+x)
  bool apparent = false;                        // that altitude is as seen, else outside the air
  bool through_air = false;                     // its own spectrum, dimmed and bent by the air above the scene
  bool limb_darkening = false;
  double site_height_m = 0;  // of z = 0 above the surface of that air
  SourcePlace altitude_place;
};

/// Direction in which light travels from a distant source at an altitude and an azimuth (from +y through +x).
Triple travel_from(double altitude_deg, double azimuth_deg);

struct CameraScene {
  Triple from{}, to{1, 0, 0}, up{0, 0, 1};
  double fov_deg = 50;  // horizontal
  std::array<int, 2> resolution{400, 300};
};

struct PhotonScene {
  std::int64_t emitted = 1000000;
  int gather = 150;                // photons of one estimate
  std::optional<double> radius_m;  // of the estimate instead
  int most_bounces = 64;
  bool aimed = true;           // caustic photons go where glass and mirrors are (projection maps), if it pays
  int precomputed = 0;         // irradiance is found at every so many photons beforehand; 0: where the eye asks
  double caustic_share = 0.3;  // of all photons, when they are
};

struct RoomScene {
  std::string name, title, file, text;
  std::vector<std::string> overrides;
  std::map<std::string, std::string> values;  // of the file, overrides included, by dotted key: to tell what changed
  std::optional<ProfileSpec> air;             // nothing: the same n = 1 everywhere
  double extinction_per_m = 0;
  /// The air above the scene, for a Sun that shines through it: the profile of the medium where that is air, else us76.
  AtmosphereScene above;
  bool above_is_medium = false;  // z is a height in that air
  CameraScene camera;
  std::vector<MaterialScene> materials;
  std::vector<TextureScene> textures;
  Surfaces surfaces;  // their material: index into materials; their light: index into lights
  std::vector<LightScene> lights;
  PhotonScene photons;
  SpectrumScene spectrum{{400.0, 700.0}, 8};
  EyeScene eye;
  OutputScene output;
  std::vector<std::string> aovs;
  std::int64_t photon_map = 0;     // photons in a picture of the photon map; 0: no such picture
  std::vector<SweepScene> sweeps;  // used by `greenray batch`
  std::vector<std::string> notes;
};

/// Does this text describe a scene with a [camera]? Text that is no TOML does not.
bool is_room_text(const std::string &file, std::string_view text);

/* The scene described by `text`; meshes, materials and textures are looked for beside `file`, then among the files
   that ship. Everything is checked: missing files, bad indices, triangles without area, unknown materials, lights that
   shine on nothing.
   errors: InputError with every complaint at once, each at the line and column of the file (scene, OBJ or MTL) */
RoomScene parse_room(const std::string &file, std::string_view text, const std::vector<std::string> &overrides = {});

/// 16 hex digits over everything that changes the picture, meshes included.
std::string room_hash(const RoomScene &scene);

}  // namespace greenray
