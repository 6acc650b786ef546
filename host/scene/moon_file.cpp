#include "scene/moon_file.hpp"

#include <cmath>
#include <stdexcept>

#include "scene/ephemeris.hpp"

namespace greenray {
namespace {

/// when, after_s, place, ut1_utc_s: everything of that moment.
void read_by_date(const TomlTable &table, double observer_height_m, MoonScene &moon) {
  UtcTime when;
  double after_s = 0, ut1_utc_s = 0;
  EarthPlace place;
  const TomlTable where = table.table("place");
  bool right = table.require("when", "a date and time, such as 2022-11-08T10:59:00Z") && table.read("when", when);
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
    const MoonSeen seen = moon_seen(when, after_s, place, ut1_utc_s);
    moon.given = MoonScene::Given::true_altitude;
    moon.altitude_deg = seen.altitude_deg;
    moon.azimuth_deg = seen.azimuth_deg;
    moon.diameter_arcmin = seen.diameter_arcmin;
    moon.phase_angle_deg = seen.phase_angle_deg;
    moon.bright_limb_deg = seen.bright_limb_deg;
    moon.sun_distance_au = seen.sun_distance_au;
    moon.by_date = true;
    constexpr double shadow_ends_arcmin = 100;  // penumbra and Moon together
    if (seen.shadow_ahead && std::hypot(seen.shadow_arcmin[0], seen.shadow_arcmin[1]) < shadow_ends_arcmin)
      moon.shadow_arcmin = seen.shadow_arcmin;
  } catch (const std::domain_error &error) {
    table.complain("when", error.what());
  }
}

}  // namespace

void read_moon(const TomlTable &table, double observer_height_m, MoonScene &moon) {
  if (!table.exists()) return;
  const Limits altitude{-90, 90, "deg"};
  const bool has_true = table.has("altitude_deg"), has_apparent = table.has("apparent_altitude_deg");
  const bool has_date = table.has("when");
  if (has_true + has_apparent + has_date > 1)
    table.complain(has_date ? "when" : "apparent_altitude_deg",
                   "expected one of altitude_deg, apparent_altitude_deg and when, found more");
  if (has_date) read_by_date(table, observer_height_m, moon);
  else
    for (const char *key : {"place", "after_s", "ut1_utc_s"})
      if (table.has(key))
        table.complain(key, "expected `when` beside it: a date and time, such as 2022-11-08T10:59:00Z");
  if (table.read("altitude_deg", moon.altitude_deg, altitude)) moon.given = MoonScene::Given::true_altitude;
  if (table.read("apparent_altitude_deg", moon.altitude_deg, altitude))
    moon.given = MoonScene::Given::apparent_altitude;
  moon.altitude_place = table.place(has_date ? "when" : has_apparent ? "apparent_altitude_deg" : "altitude_deg");
  if (!has_date && !has_true && !has_apparent)
    table.require("altitude_deg", altitude.text() + " (true), or apparent_altitude_deg (as seen), or when and place");
  table.read("azimuth_deg", moon.azimuth_deg, {-360, 360, "deg"});
  table.read("diameter_arcmin", moon.diameter_arcmin, {0, 600, "arcmin", true});
  table.read("phase_angle_deg", moon.phase_angle_deg, {0, 180, "deg"});
  table.read("bright_limb_deg", moon.bright_limb_deg, {-360, 360, "deg"});
  std::vector<double> shadow;
  if (!table.read("shadow_arcmin", shadow, {-600, 600, "arcmin"})) return;
  if (shadow.size() != 2) return table.complain("shadow_arcmin", "expected [right, up], two numbers in arcmin");
  moon.shadow_arcmin = {shadow[0], shadow[1]};
}

}  // namespace greenray
