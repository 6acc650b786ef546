// Novaya Zemlya: how far below the horizon the duct shows the Sun, and how much earlier it rises.
#include <gtest/gtest.h>

#include <cmath>

#include "atmosphere/profile_file.hpp"
#include "render/refraction.hpp"
#include "support/angle.hpp"
#include "support_code/reference_table.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

using testing_data::ReferenceTable;

RefractionTable through_the_duct(const ReferenceTable &table) {
  RefractionRequest request;
  request.height_m = 14;
  request.wavelengths_nm = {550};
  request.section = true;
  request.method = RayMethod::dormand_prince;
  request.tolerance_arcsec = 1e-3;
  for (const auto &row : table.rows()) request.altitudes_deg.push_back(row.number("apparent_deg"));
  return refraction_table(AirSection(load_profile("novaya-zemlya", "", {})), request, shared_device());
}

/// Hours before noon at which the Sun's centre stands at this altitude.
double hours_before_noon(double altitude_deg, double latitude_deg, double declination_deg) {
  const double h = to_rad(altitude_deg), p = to_rad(latitude_deg), d = to_rad(declination_deg);
  return to_deg(std::acos((std::sin(h) - std::sin(p) * std::sin(d)) / (std::cos(p) * std::cos(d)))) / 15;
}

}  // namespace

// oracle: novaya_zemlya.csv: own n(h, x), DOP853
// tolerance: 0.01" over max(1, |d true/d apparent|); the Sun at 4 to 5 degrees below is seen (issue text)
TEST(Gallery, NovayaZemlyaShowsTheSkyFarBelowTheHorizon) {
  const ReferenceTable table("../gallery/novaya_zemlya.csv");
  const RefractionTable found = through_the_duct(table);
  ASSERT_EQ(found.rows.size(), table.rows().size());
  double lowest = 0;
  for (std::size_t i = 0; i < found.rows.size(); ++i) {
    ASSERT_TRUE(found.rows[i].true_altitude_deg) << i;
    const double slope = std::max(1.0, std::abs(table.rows()[i].number("slope")));
    EXPECT_NEAR(*found.rows[i].true_altitude_deg, table.rows()[i].number("true_deg"), 0.01 / 3600 * slope) << i;
    lowest = std::min(lowest, *found.rows[i].true_altitude_deg);
  }
  EXPECT_LT(lowest, -4);
  EXPECT_GT(lowest, -5.5);
}

// oracle: the hour angle of spherical astronomy at 76 N on 20 February (declination -11 degrees), between the usual
// sunrise
//         (upper limb on the horizon: centre at -50') and that through the duct (upper limb at the lowest true altitude
//         of novaya_zemlya.csv), both worked out here
// tolerance: 1 to 2 hours; 1 s against the engine's own altitude
TEST(Gallery, NovayaZemlyaSunriseIsHoursEarly) {
  const ReferenceTable table("../gallery/novaya_zemlya.csv");
  const RefractionTable found = through_the_duct(table);
  double lowest = 0, engine = 0;
  for (std::size_t i = 0; i < found.rows.size(); ++i) {
    lowest = std::min(lowest, table.rows()[i].number("true_deg"));
    engine = std::min(engine, *found.rows[i].true_altitude_deg);
  }
  const double radius_deg = 959.63 / 3600, usual = hours_before_noon(-50.0 / 60, 76, -11);
  const double early = hours_before_noon(lowest - radius_deg, 76, -11) - usual;
  EXPECT_GT(early, 1);
  EXPECT_LT(early, 2);
  EXPECT_NEAR(hours_before_noon(engine - radius_deg, 76, -11) - usual, early, 1.0 / 3600);
}

}  // namespace greenray
