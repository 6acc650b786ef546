// Where rays pass a distance, as targets need it: many elevations at few distances.
#include "render/sight_places.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "compute/device.hpp"
#include "render/targets.hpp"
#include "support/angle.hpp"
#include "support_code/reference_table.hpp"

namespace greenray {
namespace {

using testing_data::ReferenceRow;
using testing_data::ReferenceTable;

const std::shared_ptr<Device> &device() {
  static const std::shared_ptr<Device> opened = open_device({});
  return opened;
}

ProfileSpec profile_named(const std::string &name) {
  if (name == "us76") return {};
  return load_profile(testing_data::reference_path("profiles/" + name + ".toml"), "", {});
}

struct Case {
  std::string profile;
  double height_m, wavelength_nm, distance_m;
  auto operator<=>(const Case &) const = default;
};

std::map<Case, std::vector<const ReferenceRow *>> cases_of(const ReferenceTable &table) {
  std::map<Case, std::vector<const ReferenceRow *>> cases;
  for (const ReferenceRow &row : table.rows())
    cases[{row.text("profile"), row.number("height_m"), row.number("wavelength_nm"), row.number("distance_m")}]
        .push_back(&row);
  return cases;
}

std::vector<SightPlace> places(const Case &c, const std::vector<const ReferenceRow *> &rows, RayMethod method,
                               Precision precision, bool section) {
  SkyRayOptions options;
  options.height_m = c.height_m;
  options.method = method;
  options.precision = precision;
  options.error_arcsec = precision == Precision::double_ ? 1e-4 : 0.003;
  options.step_rad = precision == Precision::double_ ? 1e-12 : 1e-9;
  std::vector<double> elevations;
  for (const ReferenceRow *row : rows) elevations.push_back(to_rad(row->number("apparent_altitude_deg")));
  SightPlaces rays(AirSection(profile_named(c.profile)), {c.wavelength_nm}, options, section, device());
  return rays.at(elevations, std::vector<double>{c.distance_m});
}

/// Largest error of height [m], over max(1, |d height/d elevation| / distance): what a shift of direction explains.
double worst_m(const Case &c, const std::vector<const ReferenceRow *> &rows, RayMethod method, Precision precision,
               bool section = false) {
  const std::vector<SightPlace> found = places(c, rows, method, precision, section);
  double worst = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto known = rows[i]->number_or_blank("height_at_distance_m");
    EXPECT_EQ(found[i].outcome == f64::RAY_IN_FLIGHT, known.has_value())
        << c.profile << " at " << rows[i]->text("apparent_altitude_deg");
    if (!known) continue;
    const auto before = i > 0 ? rows[i - 1]->number_or_blank("height_at_distance_m") : std::nullopt;
    const double step = from_arcsec(3600 * 0.0005);
    const double stretch = before ? std::max(1.0, std::abs(*known - *before) / step / c.distance_m) : 1;
    worst = std::max(worst, std::abs(found[i].height_m - *known) / stretch);
  }
  return worst;
}

}  // namespace

// oracle: reference/target_sights.csv (independent ODE): a road of hot air, a duct that inverts; ground and all turns
// tolerance: 1e-4" in double and 0.005" + 2 mm in float are what the method promises (docs/method.md); at 25 km 0.005"
// is 0.6 mm, and closed forms of layers and steps meet in both
TEST(SightPlaces, HeightsAtATargetAgainstTheOracle) {
  const ReferenceTable table("target_sights.csv");
  for (const auto &[c, rows] : cases_of(table)) {
    SCOPED_TRACE(c.profile);
    EXPECT_LT(worst_m(c, rows, RayMethod::cells, Precision::double_), 5e-5);
    EXPECT_LT(worst_m(c, rows, RayMethod::cells, Precision::single_), 0.005);
    EXPECT_LT(worst_m(c, rows, RayMethod::dormand_prince, Precision::double_), 5e-5);
    EXPECT_LT(worst_m(c, rows, RayMethod::dormand_prince, Precision::single_, true), 0.005);  // as if the air varied
  }
}

// oracle: the bits of LayerTracer with many distances a ray, whose tests are refraction_test's (trace_terrestrial.csv)
// tolerance: none, the same closed form is evaluated lane by lane
TEST(SightPlaces, RaysAbreastAndDistancesAbreastGiveTheSameBits) {
  SkyRayOptions options;
  options.height_m = 15;
  SightPlaces rays(AirSection(profile_named("duct_10K")), {450, 650}, options, false, device());
  std::vector<double> elevations, many;
  for (int i = 0; i < 101; ++i) elevations.push_back(1e-4 * (i - 50));
  for (int i = 1; i <= 16; ++i) many.push_back(2500.0 * i);
  const std::vector<SightPlace> all = rays.at(elevations, many);
  for (const std::size_t k : {std::size_t{0}, std::size_t{9}, std::size_t{15}}) {
    const std::vector<SightPlace> one = rays.at(elevations, std::vector<double>{many[k]});
    ASSERT_EQ(one.size(), elevations.size() * 2);
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(one[i].height_m, all[i * many.size() + k].height_m);
      EXPECT_EQ(one[i].column, all[i * many.size() + k].column);
      EXPECT_EQ(one[i].outcome, all[i * many.size() + k].outcome);
    }
  }
}

// oracle: Dormand-Prince steps through the index table, another route to the columns; and air of nearly constant
// density, whose column over 1 km level is density x distance (US76: 1.225 kg/m^3 at the surface)
// tolerance: 5e-4 relative, for in a layer the shapes of haze and ozone are parabolas (measured 2e-4); 0.1 %: density
// falls by 1e-4 a metre and the ray keeps within 10 m
TEST(SightPlaces, ColumnsUpToADistance) {
  SkyRayOptions options;
  options.height_m = 5;
  options.precision = Precision::double_;
  options.step_rad = 1e-11;
  const std::vector<double> elevations{-0.004, -0.001, 0.0, 0.003, 0.1}, distances{1000, 30000};
  const AirSection air(ProfileSpec{});
  const std::vector<SightPlace> layers = SightPlaces(air, {550}, options, false, device()).at(elevations, distances);
  options.method = RayMethod::dormand_prince;
  const std::vector<SightPlace> steps = SightPlaces(air, {550}, options, false, device()).at(elevations, distances);
  for (std::size_t i = 0; i < layers.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(layers[i].column[k], steps[i].column[k], 5e-4 * steps[i].column[k] + 1e-9) << i << " " << k;
  EXPECT_NEAR(layers[4].column[0] / 1225.0, 1.0, 1e-3);
}

// oracle: a straight line beyond the end: height is a continuous function of elevation where rays reach the ground
// tolerance: a thousandth of the step of elevation times the distance
TEST(SightPlaces, HeightGoesThroughZeroWhereRaysReachTheGround) {
  SkyRayOptions options;
  options.height_m = 10;
  options.precision = Precision::double_;
  SightPlaces rays(AirSection(ProfileSpec{}), {550}, options, false, device());
  const double distance = 3000, step = 1e-6, drop = 0.83 * distance * distance / (2 * 6371000.0);
  std::vector<double> elevations;
  for (int i = 0; i < 400; ++i) elevations.push_back(-(10 + drop) / distance - 2e-4 + i * step);
  const std::vector<SightPlace> found = rays.at(elevations, std::vector<double>{distance});
  int before = 0;
  for (std::size_t i = 1; i < found.size(); ++i) {
    EXPECT_NEAR(found[i].height_m - found[i - 1].height_m, step * distance, 0.02 * step * distance);
    EXPECT_EQ(found[i].height_m > 0, found[i].outcome == f64::RAY_IN_FLIGHT);
    before += found[i].height_m < 0;
  }
  EXPECT_GT(before, 50);
  EXPECT_LT(before, 350);
}

}  // namespace greenray
