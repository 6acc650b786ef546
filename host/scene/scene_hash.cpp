// scene_hash: one number for everything that changes the picture.
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "atmosphere/air_section.hpp"
#include "scene/scene_file.hpp"
#include "support/toml_reader.hpp"

namespace greenray {
namespace {

/// FNV-1a with 64 bits (offset basis and prime of the FNV reference), fed "key=value" lines.
class Fingerprint {
 public:
  void add(const char *key, const std::string &value) {
    for (const char c : std::string(key) + "=" + value + "\n") {
      hash_ ^= static_cast<unsigned char>(c);
      hash_ *= 0x100000001b3u;
    }
  }
  void add(const char *key, double value) { add(key, exact_decimal(value + 0.0)); }  // + 0.0: -0.0 becomes 0.0
  void add(const char *key, int value) { add(key, std::to_string(value)); }
  template <class Value>
  void add(const char *key, const std::optional<Value> &value) {
    if (value) add(key, *value);
    else add(key, std::string("none"));
  }
  template <class Enum>
  void add_choice(const char *key, Enum value) {
    add(key, static_cast<int>(value));
  }
  void add(const char *key, const AlongSurface &quantity) {
    for (const double x : quantity.x_m) add((std::string(key) + ".x_m").c_str(), x);
    for (const double value : quantity.value) add(key, value);
  }
  std::string hex() const {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash_));
    return text;
  }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

void add(Fingerprint &print, const ProfileSpec &profile) {
  print.add_choice("profile.base", profile.base_is_us76);
  print.add_choice("profile.index", profile.index);
  print.add("profile.earth_radius_m", profile.earth_radius_m);
  print.add("profile.surface_pressure_Pa", profile.surface_pressure_Pa);
  print.add_choice("profile.interpolation", profile.interpolation);
  print.add("profile.smooth_m", profile.smooth_m);
  print.add("profile.exaggerate", profile.exaggerate);
  for (const Level &level : profile.levels) {
    print.add("level.height_m", level.height_m);
    print.add("level.temperature_K", level.temperature_K);
    print.add("level.pressure_Pa", level.pressure_Pa);
    print.add("level.relative_humidity", level.relative_humidity);
  }
  for (const InversionSpec &inversion : profile.inversions) {
    print.add("inversion.delta_T_K", inversion.delta_T_K);
    print.add("inversion.height_m", inversion.height_m);
    print.add("inversion.diffuseness_m", inversion.diffuseness_m);
  }
  for (const SurfaceLayerSpec &layer : profile.surface_layers) {
    print.add("surface_layer.delta_T_K", layer.delta_T_K);
    print.add("surface_layer.scale_m", layer.scale_m);
  }
  for (const IndexLevel &level : profile.index_levels) {
    print.add("index_level.height_m", level.height_m);
    print.add("index_level.refractivity", level.refractivity);
  }
  if (!has_places(profile)) return;
  print.add_choice("profile.along_surface", profile.along_surface);
  print.add("profile.azimuth_deg", profile.azimuth_deg);
  for (const Station &station : profile.stations) {
    print.add("station.x_m", station.x_m);
    add(print, *station.air);
  }
}

void add(Fingerprint &print, const AtmosphereScene &air) {
  add(print, air.profile);
  print.add_choice("atmosphere.surface", air.surface);
  print.add_choice("atmosphere.humidity", air.humidity);
  print.add_choice("atmosphere.extinction", air.extinction);
  print.add("atmosphere.ozone_DU", air.ozone_DU);
  print.add("aerosol.visibility_km", air.visibility_km);
  print.add("aerosol.turbidity", air.turbidity);
  print.add("aerosol.angstrom", air.angstrom);
  print.add("aerosol.scale_height_m", air.aerosol_scale_height_m);
  print.add("aerosol.asymmetry", air.aerosol_asymmetry);
  print.add("aerosol.scattering_albedo", air.aerosol_scattering_albedo);
}

void add(Fingerprint &print, const ObserverScene &observer, const SunScene &sun, const SkyScene &sky) {
  print.add("observer.height_m", observer.height_m);
  print.add("observer.azimuth_deg", observer.azimuth_deg);
  print.add("observer.altitude_deg", observer.altitude_deg);
  print.add("observer.fov_deg", observer.fov_deg);
  print.add("observer.width", observer.resolution[0]);
  print.add("observer.height", observer.resolution[1]);
  print.add_choice("sun.given", sun.given);
  print.add_choice("sun.at", sun.part);
  print.add("sun.altitude_deg", sun.altitude_deg);
  print.add("sun.azimuth_deg", sun.azimuth_deg);
  print.add("sun.diameter_arcmin", sun.diameter_arcmin);
  print.add_choice("sun.limb_darkening", sun.limb_darkening);
  print.add_choice("sky.model", sky.model);
  print.add_choice("sky.surface", sky.surface);
  print.add("sky.wind_m_s", sky.wind_m_s);
  print.add("sky.sea_reflectance", sky.sea_reflectance);
  print.add("sky.ground_albedo", sky.ground_albedo);
}

void add(Fingerprint &print, const SpectrumScene &spectrum, const TracingScene &tracing, const EyeScene &eye) {
  print.add("spectrum.from_nm", spectrum.range_nm[0]);
  print.add("spectrum.to_nm", spectrum.range_nm[1]);
  print.add("spectrum.samples", spectrum.samples);
  print.add_choice("tracing.method", tracing.method);
  print.add_choice("tracing.transfer", tracing.transfer);
  print.add_choice("tracing.precision", tracing.precision);
  print.add_choice("tracing.dispersion", tracing.dispersion);
  print.add("tracing.tolerance", tracing.tolerance);
  print.add("tracing.table_arcsec", tracing.table_arcsec);
  print.add("tracing.max_steps", tracing.max_steps);
  print.add("tracing.spp", tracing.spp);
  print.add("tracing.error_pct", tracing.error_pct);
  print.add("tracing.minutes", tracing.minutes);
  print.add_choice("eye.model", eye.model);
  print.add("eye.exposure_ev", eye.exposure_ev);
  print.add("eye.bleaching_seconds", eye.bleaching_seconds);
  if (eye.model != EyeScene::Model::human) return;  // the rest is the human's alone
  print.add_choice("eye.bleaching_steady", eye.bleaching_steady);
  for (const std::string *word : {&eye.bleaching_model, &eye.bleaching_pool, &eye.pupil}) print.add("eye.word", *word);
  for (const bool on : {eye.glare, eye.acuity, eye.colour, eye.sensitivity}) print.add_choice("eye.switch", on);
  for (const double x : {eye.ldmax_cd_m2, eye.contrast, eye.magnification, eye.age_years}) print.add("eye.number", x);
}

/// Nothing is added for a scene without a Moon.
void add(Fingerprint &print, const MoonScene &moon) {
  if (moon.given == MoonScene::Given::nothing) return;
  print.add_choice("moon.given", moon.given);
  print.add("moon.altitude_deg", moon.altitude_deg);
  print.add("moon.azimuth_deg", moon.azimuth_deg);
  print.add("moon.diameter_arcmin", moon.diameter_arcmin);
  print.add("moon.phase_angle_deg", moon.phase_angle_deg);
  print.add("moon.bright_limb_deg", moon.bright_limb_deg);
  print.add("moon.sun_distance_au", moon.sun_distance_au);
  if (moon.shadow_arcmin)
    for (const double x : *moon.shadow_arcmin) print.add("moon.shadow_arcmin", x);
}

/// Nothing is added for a scene without targets: its hash is what it always was.
void add(Fingerprint &print, const TargetScene &target) {
  print.add_choice("target.kind", target.kind);
  print.add("target.distance_m", target.distance_m);
  print.add("target.azimuth_deg", target.azimuth_deg);
  print.add("target.offset_m", target.offset_m);
  print.add("target.base_m", target.base_m);
  print.add("target.width_m", target.width_m);
  print.add("target.height_m", target.height_m);
  for (const auto &corner : target.outline_m)
    for (const double x : corner) print.add("target.outline_m", x);
  for (const double part : target.colour) print.add("target.colour", part);
  print.add("target.luminance_cd_m2", target.luminance_cd_m2);
  if (target.picture.empty()) return;
  std::ifstream file(target.picture, std::ios::binary);
  print.add("target.picture", std::string(std::istreambuf_iterator<char>(file), {}));
}

void add(Fingerprint &print, const TerrainScene &terrain) {
  if (!terrain.field) return;
  for (const HeightTile &tile : terrain.field->tiles()) {
    for (const double x : {tile.south_deg, tile.west_deg, tile.row_deg, tile.column_deg}) print.add("terrain.tile", x);
    print.add("terrain.heights", std::to_string(tile.fingerprint));
  }
  print.add("terrain.latitude_deg", terrain.eye.latitude_deg);
  print.add("terrain.longitude_deg", terrain.eye.longitude_deg);
  print.add("terrain.farthest_m", terrain.farthest_m);
  print.add_choice("terrain.missing", terrain.missing_is_sea);
  for (const double part : terrain.reflectance) print.add("terrain.reflectance", part);
}

}  // namespace

std::string scene_hash(const Scene &scene) {
  Fingerprint print;
  add(print, scene.atmosphere);
  add(print, scene.observer, scene.sun, scene.sky);
  add(print, scene.spectrum, scene.tracing, scene.eye);
  print.add_choice("output.spectral", scene.output.spectral);
  add(print, scene.moon);
  for (const TargetScene &target : scene.targets) add(print, target);
  add(print, scene.terrain);
  if (scene.sea.rough) {
    print.add("sea.wind_m_s", scene.sea.wind_m_s);
    print.add("sea.significant_height_m", scene.sea.significant_height_m);
  }
  return print.hex();
}

}  // namespace greenray
