// [[light]]: where light comes from, and which surfaces shine.
#include <algorithm>
#include <cmath>

#include "scene/room_reader.hpp"

namespace greenray {
namespace {

const Limits anywhere{-1e6, 1e6, "m"};

void read_shape(const TomlTable &row, Colour &colour) {
  const bool has_temperature = row.has("temperature_K"), has_colour = row.has("colour");
  if (has_temperature && has_colour) row.complain("colour", "expected either colour or temperature_K, found both");
  if (row.read("temperature_K", colour.temperature_K, {500, 1e5, "K"})) colour.kind = Colour::Kind::blackbody;
  read_colour(row, "colour", colour, {0, 1e6});
  if (has_colour && colour.rgb == std::array<double, 3>{0, 0, 0})
    row.complain("colour", "expected a colour that is not black");
}

/// from, and to or direction.
void read_aim(const TomlTable &row, LightScene &light) {
  row.require("from", "a place, [x, y, z] in m");
  Triple to{};
  read_triple(row, "from", light.from, anywhere);
  row.require("to", "a place it shines at, [x, y, z] in m");
  if (!read_triple(row, "to", to, anywhere)) return;
  if (length(to - light.from) == 0) return row.complain("to", "expected a place other than `from`");
  light.direction = unit(to - light.from);
}

/// Where it stands: a true altitude, or an apparent one.
void read_altitude(const TomlTable &row, LightScene &light) {
  const Limits limits{-90, 90, "deg"};
  const bool has_true = row.has("altitude_deg"), has_apparent = row.has("apparent_altitude_deg");
  if (has_true && has_apparent)
    row.complain("apparent_altitude_deg", "expected either altitude_deg or apparent_altitude_deg, found both");
  if (!has_true && !has_apparent)
    row.require("altitude_deg", limits.text() + " (true), or apparent_altitude_deg (as seen)");
  row.read("altitude_deg", light.altitude_deg, limits);
  light.apparent = row.read("apparent_altitude_deg", light.altitude_deg, limits);
  light.altitude_place = row.place(has_apparent ? "apparent_altitude_deg" : "altitude_deg");
  row.read("azimuth_deg", light.azimuth_deg, {-360, 360, "deg"});
  light.direction = travel_from(light.altitude_deg, light.azimuth_deg);
}

/// Without an irradiance: the real Sun, through the air above the scene.
void read_sun(const TomlTable &row, bool z_is_height, LightScene &light) {
  read_altitude(row, light);
  row.read("diameter_deg", light.diameter_deg, {0, 90, "deg"});
  light.through_air = !row.has("irradiance_W_m2");
  light.limb_darkening = light.through_air;
  row.read("irradiance_W_m2", light.irradiance_W_m2, {0, 1e12, "W/m2", true});
  row.read("limb_darkening", light.limb_darkening);
  row.read("site_height_m", light.site_height_m, {0, 1e5, "m"});
  if (row.has("site_height_m") && (z_is_height || !light.through_air))
    row.complain("site_height_m", z_is_height ? "z is a height in the scene's own profile already"
                                              : "expected no irradiance_W_m2 beside it: that is what arrives");
  for (const char *key : {"colour", "temperature_K"})
    if (light.through_air && row.has(key))
      row.complain(key,
                   "expected irradiance_W_m2 beside it: without one the Sun has its own spectrum, through the air");
}

void read_area(const TomlTable &row, const RoomNames &names, int number, RoomScene &scene) {
  std::string name;
  row.require("surface", "the name of a [[quad]], [[box]], [[sphere]] or [[mesh]] that shines");
  if (!row.read("surface", name)) return;
  const auto found = names.find(name);
  if (found == names.end()) {
    std::vector<std::string> known;
    for (const auto &[word, surfaces] : names) known.push_back(word);
    return row.complain("surface", "nothing is named '" + name + "'" + did_you_mean(name, known));
  }
  for (const std::size_t i : found->second.triangles) {
    if (scene.surfaces.triangles[i].light >= 0) return row.complain("surface", "'" + name + "' shines already");
    scene.surfaces.triangles[i].light = number;
  }
  for (const std::size_t i : found->second.spheres) {
    if (scene.surfaces.spheres[i].light >= 0) return row.complain("surface", "'" + name + "' shines already");
    scene.surfaces.spheres[i].light = number;
  }
}

void read_light(const TomlTable &row, const RoomNames &names, RoomScene &scene) {
  using Kind = LightScene::Kind;
  LightScene light;
  light.place = row.place();
  row.require("kind", "one of spot, point, area, sun");
  row.read_word("kind", light.kind,
                {{"spot", Kind::spot}, {"point", Kind::point}, {"area", Kind::area}, {"sun", Kind::sun}});
  if (light.kind == Kind::point) {
    row.require("from", "a place, [x, y, z] in m");
    read_triple(row, "from", light.from, anywhere);
  }
  if (light.kind == Kind::spot) {
    read_aim(row, light);
    row.require("cone_deg", "the full angle of the cone, above 0 and at most 180 deg");
    row.read("cone_deg", light.cone_deg, {0, 180, "deg", true});
  }
  if (light.kind == Kind::area) read_area(row, names, static_cast<int>(scene.lights.size()), scene);
  if (light.kind == Kind::sun) {
    read_sun(row, scene.above_is_medium, light);
  } else {
    row.require("power_W", "a number above 0 W");
    row.read("power_W", light.power_W, {0, 1e15, "W", true});
  }
  row.read("photon_weight", light.photon_weight, {1e-3, 1e3});
  read_shape(row, light.colour);
  scene.lights.push_back(light);
}

double area_of_light_m2(const Surfaces &surfaces, int light) {
  double area = 0;
  for (const Triangle &t : surfaces.triangles)
    if (t.light == light) area += length(t.area_vector_m2());
  for (const Sphere &s : surfaces.spheres)
    if (s.light == light) area += 4 * M_PI * s.radius_m * s.radius_m;
  return area;
}

/// Lights of MTL files come with a radiance, linear Rec. 709 in W m^-2 sr^-1: power = pi radiance area.
void give_power(RoomScene &scene) {
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    LightScene &light = scene.lights[i];
    if (light.kind != LightScene::Kind::area || light.power_W >= 0) continue;
    const auto &c = light.colour.rgb;
    const double mean = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    light.power_W = M_PI * mean * area_of_light_m2(scene.surfaces, static_cast<int>(i));
  }
}

}  // namespace

Triple travel_from(double altitude_deg, double azimuth_deg) {
  const double a = altitude_deg * M_PI / 180, z = azimuth_deg * M_PI / 180;
  return {-std::cos(a) * std::sin(z), -std::cos(a) * std::cos(z), -std::sin(a)};
}

void read_room_lights(const TomlTable &root, const RoomNames &names, RoomScene &scene) {
  for (const TomlTable &row : root.rows("light")) read_light(row, names, scene);
  give_power(scene);
  if (scene.lights.empty() && root.has("camera"))
    root.require("light", "at least one [[light]], or an MTL material with Ke");
}

}  // namespace greenray
