// Rays followed for 1 to 1000 km along the surface through the hard airs, sphere and flat.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <set>
#include <sstream>

#include "render/refraction.hpp"
#include "support_code/hard_cases.hpp"

namespace greenray {
namespace {

using testing_data::hard_profile;
using testing_data::ReferenceRow;
using testing_data::ReferenceTable;

using Group = std::tuple<std::string, double, bool>;  // air, eye, flat
using Place = std::pair<double, double>;              // altitude, distance

std::map<Place, TraceRow> follow(const Group &group, const std::vector<const ReferenceRow *> &rows, Precision precision,
                                 RayMethod method) {
  std::set<double> altitudes, distances;
  for (const ReferenceRow *row : rows) {
    altitudes.insert(row->number("apparent_altitude_deg"));
    distances.insert(row->number("distance_m"));
  }
  TraceRequest request;
  request.height_m = std::get<1>(group);
  request.flat = std::get<2>(group);
  request.altitudes_deg.assign(altitudes.begin(), altitudes.end());
  request.distances_m.assign(distances.begin(), distances.end());
  request.wavelengths_nm = {550};
  request.precision = precision;
  request.method = method;
  request.tolerance_arcsec = precision == Precision::double_ ? 1e-6 : 0.005;
  std::map<Place, TraceRow> found;
  for (const TraceRow &row : trace_table(hard_profile(std::get<0>(group)), request, shared_device()))
    found[{row.apparent_altitude_deg, row.distance_m}] = row;
  return found;
}

/// Largest differences, over `amplification` and over the distance beyond 50 km.
struct WorstPlace {
  double height_m = 0, arcsec = 0, path = 0, end_height_m = 0;
  std::string where;
};

void compare(const ReferenceRow &row, const TraceRow &got, RayMethod method, bool fine, WorstPlace &worst) {
  std::ostringstream text;
  text << "greenray trace " << row.text("profile") << ".toml --height " << row.text("height_m") << " --altitudes "
       << row.text("apparent_altitude_deg") << " --wavelengths 550 --distances " << row.text("distance_m")
       << " --surface " << row.text("surface") << " --precision " << (fine ? "double" : "float") << " --method "
       << method_name(method);
  ASSERT_EQ(outcome_name(got.outcome), row.text("status")) << text.str();
  ASSERT_TRUE(std::isfinite(got.height_m) && std::isfinite(got.elevation_deg) && std::isfinite(got.bending_arcsec) &&
              std::isfinite(got.optical_path_m))
      << text.str();
  const double height = std::abs(got.height_m - row.number("end_height_m"));
  const double amplification = row.number("amplification");
  if (amplification == 0) {  // where it ended: on the ground or at the top
    worst.end_height_m = std::max(worst.end_height_m, height);
    return;
  }
  const double longer = amplification * std::max(1.0, row.number("distance_m") / 50000);
  const double arcsec = std::max(3600 * std::abs(got.elevation_deg - row.number("elevation_deg")),
                                 std::abs(got.bending_arcsec - row.number("bending_arcsec")));
  if (height / longer > worst.height_m) worst.where = text.str();
  worst.height_m = std::max(worst.height_m, height / longer);
  // A direction along a ray in a duct changes by up to 1e-6 rad (0.2 arcsec) per metre of height.
  worst.arcsec = std::max(worst.arcsec, arcsec / longer);
  worst.path = std::max(worst.path, std::abs(got.optical_path_m / row.number("optical_path_m") - 1) / longer);
}

template <class Twin>
class HardTrace : public ::testing::Test {};
using Twins = ::testing::Types<Single, Double>;
TYPED_TEST_SUITE(HardTrace, Twins);

TYPED_TEST(HardTrace, HeightsUpToAThousandKilometres) {
  // oracle: reference/hard/trace.csv: ODE, kept where quadrature agrees
  // tolerance: asked for: 1 cm (float), 0.1 mm (double) of height at 50 km, growing with the distance beyond and with
  // how
  //            much more than in straight flight the height moves with the direction; of direction 0.05 and 5e-4
  //            arcsec; of path 5e-6 (float, its own rounding) and 1e-8
  const ReferenceTable table("hard/trace.csv");
  std::map<Group, std::vector<const ReferenceRow *>> groups;
  for (const ReferenceRow &row : table.rows())
    groups[{row.text("profile"), row.number("height_m"), row.text("surface") == "flat"}].push_back(&row);
  ASSERT_GE(table.rows().size(), 400u);
  for (RayMethod method : {RayMethod::cells, RayMethod::dormand_prince}) {
    SCOPED_TRACE(method_name(method));
    WorstPlace worst;
    for (const auto &[group, rows] : groups) {
      const std::map<Place, TraceRow> found = follow(group, rows, TypeParam::precision, method);
      for (const ReferenceRow *row : rows)
        compare(*row, found.at({row->number("apparent_altitude_deg"), row->number("distance_m")}), method,
                TypeParam::is_double, worst);
    }
    std::cout << method_name(method) << ": worst height " << worst.height_m << " m, direction " << worst.arcsec
              << "\", path " << worst.path << ", end " << worst.end_height_m << " m: " << worst.where << "\n";
    EXPECT_LT(worst.height_m, TypeParam::is_double ? 1e-4 : 0.01) << worst.where;
    EXPECT_LT(worst.arcsec, TypeParam::is_double ? 5e-4 : 0.05);
    EXPECT_LT(worst.path, TypeParam::is_double ? 1e-8 : 5e-6);
    EXPECT_LT(worst.end_height_m, TypeParam::is_double ? 1e-4 : 0.02);
  }
}

}  // namespace
}  // namespace greenray
