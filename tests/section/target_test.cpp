// Targets through air that varies along the surface: where rays pass their distances, and what pictures show of them.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "render/renderer.hpp"
#include "render/sight_places.hpp"
#include "scene/scene_file.hpp"
#include "support/angle.hpp"
#include "support_code/reference_table.hpp"

namespace greenray {
namespace {

using testing_data::reference_path;
using testing_data::ReferenceRow;
using testing_data::ReferenceTable;

const std::shared_ptr<Device> &device() {
  static const std::shared_ptr<Device> opened = open_device({});
  return opened;
}

std::string file_of(const std::string &profile) {
  return profile == "novaya-zemlya" ? profile : reference_path("section/profiles/" + profile + ".toml");
}

struct Case {
  std::string profile;
  double height_m, distance_m;
  auto operator<=>(const Case &) const = default;
};

using Rows = std::vector<const ReferenceRow *>;
std::map<Case, Rows> cases_of(const ReferenceTable &table) {
  std::map<Case, Rows> cases;
  for (const ReferenceRow &row : table.rows())
    cases[{row.text("profile"), row.number("height_m"), row.number("distance_m")}].push_back(&row);
  return cases;
}

/// m of height for a radian of direction, at the row, by its neighbours.
double stretch_m(const Rows &rows, std::size_t i) {
  double most = 0;
  for (const std::size_t k : {i > 0 ? i - 1 : i, i + 1 < rows.size() ? i + 1 : i}) {
    const auto here = rows[i]->number_or_blank("height_at_distance_m"),
               there = rows[k]->number_or_blank("height_at_distance_m");
    if (k == i || !here || !there) continue;
    const double apart = to_rad(rows[k]->number("apparent_altitude_deg") - rows[i]->number("apparent_altitude_deg"));
    most = std::max(most, std::abs((*there - *here) / apart));
  }
  return most;
}

}  // namespace

// oracle: reference/section/target_sights.csv: T, P and the ray integrated apart from all of this (section.py, route 1)
// tolerance: what the solver for sections promises (docs/method.md): as an angle at the eye 1e-5" in double with a
// table of 1e-4", 0.01" in float with one of 0.003", each over max(1, |d height/d elevation| / distance); and a
// micrometre, 4 mm
TEST(SectionTargets, RaysPassDistancesAtTheHeightsOfTheOracle) {
  const ReferenceTable table("section/target_sights.csv");
  for (const Precision precision : {Precision::double_, Precision::single_})
    for (const auto &[c, rows] : cases_of(table)) {
      const bool fine = precision == Precision::double_;
      SkyRayOptions options;
      options.height_m = c.height_m;
      options.method = RayMethod::dormand_prince;
      options.precision = precision;
      options.error_arcsec = fine ? 1e-4 : 0.003;
      options.step_rad = fine ? 1e-12 : 1e-9;
      std::vector<double> elevations;
      for (const ReferenceRow *row : rows) elevations.push_back(to_rad(row->number("apparent_altitude_deg")));
      SightPlaces rays(AirSection(load_profile(file_of(c.profile), "", {})), {550}, options, true, device());
      const std::vector<SightPlace> found = rays.at(elevations, std::vector<double>{c.distance_m});
      int seen = 0;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto known = rows[i]->number_or_blank("height_at_distance_m");
        const std::string where = c.profile + " " + rows[i]->text("apparent_altitude_deg");
        ASSERT_EQ(found[i].outcome == f64::RAY_IN_FLIGHT, known.has_value()) << where;
        if (!known) continue;
        ++seen;
        const double arcsec = fine ? 1e-5 : 0.01;
        EXPECT_NEAR(found[i].height_m, *known,
                    (fine ? 1e-6 : 4e-3) + from_arcsec(arcsec) * std::max(stretch_m(rows, i), c.distance_m))
            << where;
      }
      EXPECT_GT(seen, 15) << c.profile;
    }
}

// oracle: the same rows: the height that a wall shows at each altitude, and where it is upside down
// tolerance: a fiftieth of a pixel and 1 cm: each row lies in the middle of a pixel; the picture's plane is that much
// from even steps of altitude at its edge, and its air from that of rays beside the middle column
TEST(SectionTargets, APictureShowsTheHeightsOfTheOracle) {
  const ReferenceTable table("section/target_sights.csv");
  int inverted = 0;
  for (const auto &[c, rows] : cases_of(table)) {
    if (c.profile != "falling_layer") continue;
    Scene scene = parse_scene("wall.toml",
                              "greenray = 1\n[atmosphere]\nprofile = \"" + file_of(c.profile) +
                                  "\"\nextinction = false\n[observer]\nazimuth_deg = 0.0\n[sky]\nmodel = \"academic\"\n"
                                  "[spectrum]\nsamples = 1\nrange_nm = [550.0, 550.0]\n"
                                  "[tracing]\nquality = { spp = 1 }\n");
    const int count = static_cast<int>(rows.size());
    const double first = rows.front()->number("apparent_altitude_deg"),
                 last = rows.back()->number("apparent_altitude_deg"), step = (last - first) / (count - 1);
    scene.observer.height_m = c.height_m;
    scene.observer.altitude_deg = 0.5 * (first + last);
    scene.observer.resolution = {8, count};
    scene.observer.fov_deg = 8 * step;
    TargetScene wall;
    wall.distance_m = c.distance_m, wall.width_m = 1e5, wall.height_m = 1e5, wall.luminance_cd_m2 = 1;
    scene.targets.push_back(wall);
    const Rendered made = render(scene, plan_render(scene, {}), {}, device());
    const auto &height = made.image.channels.at("target_height_m"),
               &distance = made.image.channels.at("target_distance_m");
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto known = rows[i]->number_or_blank("height_at_distance_m");
      const std::size_t pixel = 8 * (rows.size() - 1 - i) + 4;
      const std::string where = rows[i]->text("apparent_altitude_deg");
      ASSERT_EQ(distance[pixel] > 0, known.has_value()) << where;
      if (!known) continue;
      EXPECT_NEAR(static_cast<double>(height[pixel]), *known, 0.01 + 0.02 * to_rad(step) * stretch_m(rows, i)) << where;
      const auto before = i > 0 ? rows[i - 1]->number_or_blank("height_at_distance_m") : std::nullopt;
      inverted += before && *known < *before;
    }
    EXPECT_LT(made.report.target_arcsec.value(), 3600 * step * 0.05);
  }
  EXPECT_GT(inverted, 0);
}

}  // namespace greenray
