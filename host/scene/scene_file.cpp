#include "scene/scene_file.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "atmosphere/profile_file.hpp"
#include "scene/absorbers_file.hpp"
#include "scene/ephemeris.hpp"
#include "scene/eye_file.hpp"
#include "scene/moon_file.hpp"
#include "scene/target_file.hpp"
#include "scene/terrain_file.hpp"
#include "support/embedded.hpp"
#include "support/toml_reader.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;

/// Rooms, meshes and photons are another kind of scene: said once, instead of a complaint about each of their keys.
void refuse_geometry(const TomlTable &root) {
  const std::string message =
      "belongs to scenes with a [camera]; a sky scene has [atmosphere], "
      "[observer] and [sun]";
  for (const char *key : {"camera", "mesh", "light", "photons"})
    if (root.has(key)) throw InputError(root.place(key), "'" + std::string(key) + "': " + message);
  if (root.holds_table("atmosphere") && root.table("atmosphere").has("field"))
    throw InputError(root.table("atmosphere").place("field"), "'atmosphere.field': " + message);
}

void read_header(const TomlTable &root, Scene &scene) {
  int version = 1;
  const char *expected = "1, the version of the scene format";
  if (root.require("greenray", expected) && root.read("greenray", version, {0, 1e9}) && version != 1)
    root.complain("greenray", std::string("expected ") + expected + ", found " + std::to_string(version));
  root.read("title", scene.title);
}

/// [atmosphere]: the profile is loaded first, then the keys that change it.
void read_atmosphere(TomlDocument &document, const TomlTable &table, const std::string &folder, AtmosphereScene &air) {
  table.read("profile", air.profile_source);
  try {
    air.profile = load_profile(air.profile_source, folder, table.place("profile"));
  } catch (const InputError &error) {
    document.complain(error);
  }
  table.read_word("surface", air.surface, {{"sphere", Surface::sphere}, {"flat", Surface::flat}});
  double radius_km = 0;
  if (table.read("radius_km", radius_km, {1, 1e6, "km"})) air.profile.earth_radius_m = 1000 * radius_km;
  table.read_word("dispersion", air.profile.index, index_model_words());
  double exaggerate = 1;
  if (table.read("exaggerate", exaggerate, {0, 1e6, "", true})) air.profile.exaggerate *= exaggerate;
  table.read("humidity", air.humidity);
  read_absorbers(table, air);
}

void read_observer(const TomlTable &table, ObserverScene &observer) {
  table.read("height_m", observer.height_m, {0, 1e7, "m"});
  table.read("azimuth_deg", observer.azimuth_deg, {-360, 360, "deg"});
  table.read("altitude_deg", observer.altitude_deg, {-90, 90, "deg"});
  table.read("fov_deg", observer.fov_deg, {0, 180, "deg", true, true});
  std::vector<double> size;
  if (!table.read("resolution", size, {1, 16384, "pixels"})) return;
  if (size.size() != 2 || size[0] != std::floor(size[0]) || size[1] != std::floor(size[1]))
    return table.complain("resolution", "expected [width, height], two whole numbers of pixels");
  observer.resolution = {static_cast<int>(size[0]), static_cast<int>(size[1])};
}

/// when, after_s, place, ut1_utc_s: altitude, azimuth and diameter of that moment.
void read_sun_by_date(const TomlTable &table, double observer_height_m, SunScene &sun) {
  UtcTime when;
  double after_s = 0, ut1_utc_s = 0;
  EarthPlace place;
  const TomlTable where = table.table("place");
  bool right = table.require("when", "a date and time, such as 2024-06-21T20:31:05Z") && table.read("when", when);
  right = table.require("place", "{ latitude_deg = .., longitude_deg = .. }") && right;
  if (where.exists()) {
    right = where.require("latitude_deg", "a number from -90 to 90 deg") && right;
    right = where.require("longitude_deg", "a number from -180 to 360 deg, east positive") && right;
    where.read("latitude_deg", place.latitude_deg, {-90, 90, "deg"});
    where.read("longitude_deg", place.longitude_deg, {-180, 360, "deg"});
  }
  table.read("after_s", after_s, {-1e9, 1e9, "s"});
  table.read("ut1_utc_s", ut1_utc_s, {-1, 1, "s"});
  if (!right) return;
  place.height_m = observer_height_m;
  try {
    const SunSeen seen = sun_seen(when, after_s, place, ut1_utc_s);
    sun.given = SunScene::Given::true_altitude;
    sun.altitude_deg = seen.altitude_deg;
    sun.azimuth_deg = seen.azimuth_deg;
    sun.diameter_arcmin = seen.diameter_arcmin;
    sun.by_date = true;
  } catch (const std::domain_error &error) {
    table.complain("when", error.what());
  }
}

void read_sun(const TomlTable &table, double observer_height_m, SunScene &sun) {
  const Limits altitude{-90, 90, "deg"};
  const bool has_true = table.has("altitude_deg"), has_apparent = table.has("apparent_altitude_deg");
  const bool has_date = table.has("when");
  if (has_true + has_apparent + has_date > 1)
    table.complain(has_date ? "when" : "apparent_altitude_deg",
                   "expected one of altitude_deg, apparent_altitude_deg and when, found more");
  if (has_date) read_sun_by_date(table, observer_height_m, sun);
  bool left_over = false;  // keys of a date without one; no harm where -D gives an altitude instead
  for (const char *key : {"place", "after_s", "ut1_utc_s"})
    if (table.has(key) && !has_date && !has_true && !has_apparent && !left_over) {
      left_over = true;
      table.complain(key, "expected `when` beside it: a date and time, such as 2024-06-21T20:31:05Z");
    }
  if (table.read("altitude_deg", sun.altitude_deg, altitude)) sun.given = SunScene::Given::true_altitude;
  if (table.read("apparent_altitude_deg", sun.altitude_deg, altitude)) sun.given = SunScene::Given::apparent_altitude;
  sun.altitude_place = table.place(has_date ? "when" : has_apparent ? "apparent_altitude_deg" : "altitude_deg");
  if (table.exists() && !has_date && !has_true && !has_apparent && !left_over)
    table.require("altitude_deg", altitude.text() + " (true), or apparent_altitude_deg (as seen), or when and place");
  table.read_word("at", sun.part,
                  {{"centre", SunScene::Part::centre},
                   {"upper-limb", SunScene::Part::upper_limb},
                   {"lower-limb", SunScene::Part::lower_limb}});
  table.read("azimuth_deg", sun.azimuth_deg, {-360, 360, "deg"});
  table.read("diameter_arcmin", sun.diameter_arcmin, {0, 5400, "arcmin", true});
  table.read("limb_darkening", sun.limb_darkening);
}

void read_sky(const TomlTable &table, SkyScene &sky) {
  table.read_word("model", sky.model, {{"plain", SkyScene::Model::plain}, {"academic", SkyScene::Model::academic}});
  table.read_word("surface", sky.surface, {{"sea", SkyScene::Surface::sea}, {"land", SkyScene::Surface::land}});
  table.read("wind_m_s", sky.wind_m_s, {0, 30, "m/s"});
  table.read("sea_reflectance", sky.sea_reflectance, {0, 1});
  if (sky.surface == SkyScene::Surface::land) {
    constexpr double albedo_of_land = 0.2;
    sky.ground_albedo = albedo_of_land;
    for (const char *key : {"wind_m_s", "sea_reflectance"})
      if (table.has(key)) table.complain(key, "belongs to surface = \"sea\"");
  }
  table.read("ground_albedo", sky.ground_albedo, {0, 1});
}

/// One wind raises the waves before the horizon and those that mirror the sky, unless [sky] has one of its own.
void agree_on_sea(const TomlTable &root, Scene &scene) {
  if (!scene.sea.rough) return;
  if (scene.sky.surface == SkyScene::Surface::land)
    root.table("sea").complain("wind_m_s", "expected no [sea] where sky.surface = \"land\"");
  if (!root.table("sky").has("wind_m_s")) scene.sky.wind_m_s = scene.sea.wind_m_s;
}

void read_spectrum(const TomlTable &table, SpectrumScene &spectrum) {
  table.read("samples", spectrum.samples, {1, 256});
  std::vector<double> range;
  if (table.read("range_nm", range, {360, 830, "nm"})) {
    const bool one = spectrum.samples == 1;  // monochromatic: from and to may be the same
    if (range.size() != 2 || !(one ? range[0] <= range[1] : range[0] < range[1]))
      table.complain("range_nm", "expected [from, to] in nm, from below to (or the same with samples = 1)");
    else spectrum.range_nm = {range[0], range[1]};
  }
}

void read_tracing(const TomlTable &table, TracingScene &tracing) {
  using T = TracingScene;
  table.read_word("method", tracing.method,
                  {{"auto", T::Method::automatic},
                   {"cells", T::Method::cells},
                   {"rk45", T::Method::rk45},
                   {"richardson", T::Method::richardson}});
  table.read_word("transfer", tracing.transfer, {{"table", T::Transfer::table}, {"per-pixel", T::Transfer::per_pixel}});
  table.read_word(
      "precision", tracing.precision,
      {{"auto", T::Precision::automatic}, {"float", T::Precision::single_}, {"double", T::Precision::double_}});
  table.read_word("dispersion", tracing.dispersion,
                  {{"auto", T::Dispersion::automatic}, {"on", T::Dispersion::on}, {"off", T::Dispersion::off}});
  table.read("tolerance", tracing.tolerance, {1e-14, 1e-2, "rad", true, true});
  table.read("table_arcsec", tracing.table_arcsec, {0, 60, "arcsec", true});
  table.read("max_steps", tracing.max_steps, {10, 100000000, "steps"});
  const TomlTable quality = table.table("quality");
  quality.read("spp", tracing.spp, {1, 1000000, "samples per pixel"});
  quality.read("error_pct", tracing.error_pct, {0, 100, "%", true});
  quality.read("minutes", tracing.minutes, {0, 1e6, "minutes", true});
}

void read_output(const TomlTable &table, OutputScene &output) {
  table.read("image", output.image);
  table.read("spectral", output.spectral);
  if (!output.image.empty() && fs::path(output.image).extension() != ".exr")
    table.complain("image", "expected a file name that ends in .exr, found \"" + output.image + "\"");
}

}  // namespace

Scene parse_scene(const std::string &file, std::string_view text, const std::vector<std::string> &overrides) {
  TomlDocument document(file, text);
  for (const std::string &assignment : overrides) document.override_with(assignment);
  document.prefer_overridden("sun", "altitude_deg", "apparent_altitude_deg");
  for (const char *altitude : {"altitude_deg", "apparent_altitude_deg"})
    document.prefer_overridden("sun", altitude, "when");
  document.prefer_overridden("moon", "altitude_deg", "apparent_altitude_deg");
  for (const char *altitude : {"altitude_deg", "apparent_altitude_deg"})
    document.prefer_overridden("moon", altitude, "when");
  document.prefer_overridden("atmosphere.aerosol", "visibility_km", "turbidity");
  const TomlTable root = document.root();
  refuse_geometry(root);

  Scene scene;
  scene.name = fs::path(file).stem().string();
  scene.file = file;
  scene.text = std::string(text);
  scene.overrides = overrides;
  read_header(root, scene);
  read_atmosphere(document, root.table("atmosphere"), fs::path(file).parent_path().string(), scene.atmosphere);
  const TomlTable observer = root.table("observer");
  read_observer(observer, scene.observer);
  read_sun(root.table("sun"), scene.observer.height_m, scene.sun);
  if (scene.sun.by_date && !observer.has("azimuth_deg")) scene.observer.azimuth_deg = *scene.sun.azimuth_deg;
  read_moon(root.table("moon"), scene.observer.height_m, scene.moon);
  if (scene.moon.by_date && !scene.sun.by_date && !observer.has("azimuth_deg"))
    scene.observer.azimuth_deg = *scene.moon.azimuth_deg;
  read_sky(root.table("sky"), scene.sky);
  read_sea(root.table("sea"), scene.sea);
  agree_on_sea(root, scene);
  read_spectrum(root.table("spectrum"), scene.spectrum);
  read_tracing(root.table("tracing"), scene.tracing);
  read_eye_scene(root.table("eye"), scene.eye);
  read_output(root.table("output"), scene.output);
  read_targets(root, fs::path(file).parent_path().string(), scene);
  read_terrain(document, root.table("terrain"), observer, fs::path(file).parent_path().string(), scene);
  scene.sweeps = read_sweeps(document, root);
  document.finish();
  return scene;
}

std::vector<std::string> shipped_scenes() {
  std::vector<std::string> names;
  for (const std::string &path : embedded_files("scenes/"))
    if (fs::path(path).extension() == ".toml" && fs::path(path).stem() != "template")
      names.push_back(fs::path(path).stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

Scene load_scene(const std::string &name_or_file, const std::vector<std::string> &overrides,
                 const std::optional<SourcePlace> &asked_at) {
  const SourcePlace place = asked_at.value_or(SourcePlace{name_or_file, 1, 1});
  if (const auto text = file_contents(name_or_file, max_toml_bytes, place))
    return parse_scene(name_or_file, *text, overrides);
  const std::string shipped = "scenes/" + name_or_file + ".toml";
  if (const auto text = embedded_file(shipped)) return parse_scene(shipped, *text, overrides);
  const std::vector<std::string> names = shipped_scenes();
  throw InputError(place, "'" + name_or_file + "' is neither a scene file nor a shipped scene" +
                              did_you_mean(name_or_file, names) + "; shipped: " + comma_list(names));
}

}  // namespace greenray
