// US Standard Atmosphere 1976: temperature, lapse and geopotential.
#include "atmosphere/standard_atmosphere.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support_code/reference_table.hpp"

namespace greenray {
namespace {

using testing_data::ReferenceRow;
using testing_data::ReferenceTable;

TEST(StandardAtmosphere, TemperatureAtTheLayerBoundaries) {
  // oracle: reference/us76_boundaries.csv, the defining table of the standard
  // tolerance: 1e-9 K: heights printed to 1e-10 m times 6.5 mK/m
  const ReferenceTable table("us76_boundaries.csv");
  EXPECT_GE(table.rows().size(), 8u);
  for (const ReferenceRow &row : table.rows()) {
    const double h = row.number("height_m");
    EXPECT_NEAR(us76::geopotential_m(h), row.number("geopotential_m"), 1e-8);
    EXPECT_NEAR(us76::temperature_K(h).value, row.number("temperature_K"), 1e-9);
  }
}

TEST(StandardAtmosphere, GeopotentialAndGeometricHeightAreInverse) {
  // oracle: the published pair 11000 gpm = 11019 m, and the inverse function
  // tolerance: published to 1 m; inverse to 1e-15 relative
  EXPECT_NEAR(us76::geometric_m(11000), 11019, 0.5);
  EXPECT_NEAR(us76::geometric_m(84852), 86000, 0.5);
  for (double h : {0.0, 1.0, 2500.0, 47000.0, 120000.0})
    EXPECT_NEAR(us76::geometric_m(us76::geopotential_m(h)), h, 4e-15 * h);
}

TEST(StandardAtmosphere, LapseIsTheSlopeOfTheTemperature) {
  // oracle: central differences of the temperature, 1 m to each side, off the boundaries
  // tolerance: 1e-10 K/m: 3e-14 K of rounding over 2 m, and the third derivative
  for (double h : {5.0, 3000.0, 10900.0, 15000.0, 25000.0, 40000.0, 49000.0, 60000.0, 80000.0, 100000.0}) {
    const double slope = (us76::temperature_K(h + 1).value - us76::temperature_K(h - 1).value) / 2;
    EXPECT_NEAR(us76::temperature_K(h).slope, slope, 1e-10) << h;
  }
}

TEST(StandardAtmosphere, IsIsothermalAboveTheLastLayer) {
  // oracle: the project's rule: 186.946 K above 84.852 geopotential km
  // tolerance: exact
  for (double h : {86001.0, 100000.0, 120000.0}) {
    EXPECT_EQ(us76::temperature_K(h).value, 186.946);
    EXPECT_EQ(us76::temperature_K(h).slope, 0);
  }
}

}  // namespace
}  // namespace greenray
