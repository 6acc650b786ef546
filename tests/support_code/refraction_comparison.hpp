// Holds refraction tables against the tables of tests/data/reference, row by row.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "render/refraction.hpp"
#include "support/angle.hpp"
#include "support_code/reference_table.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray::testing_data {

/// The largest differences of a table from the oracle, in the units named.
struct Worst {
  double refraction_arcsec = 0;  // over max(1, |dRda|), rows that reach space
  double ground_arcsec = 0;      // of rows that end on the ground
  double height_m = 0;           // of lowest and highest points
  double distance_m = 0;
  double air_mass = 0;      // relative
  double beyond_claim = 0;  // error [arcsec] beyond both the tolerance asked for and 1.2 times the row's own estimate
  int rows = 0;
};

struct Columns {
  const char *height = "height_m", *wavelength = "wavelength_nm", *minimum = "min_height_m", *maximum = "max_height_m",
             *distance = "ground_distance_m";
  bool has_air_mass = true;
};

inline void compare_row(const ReferenceRow &row, const RefractionRow &got, const Columns &columns,
                        double tolerance_arcsec, Worst &worst) {
  const std::string where = row.text(columns.height) + " m " + row.text("apparent_altitude_deg") + " deg " +
                            row.text(columns.wavelength) + " nm";
  ASSERT_EQ(outcome_name(got.outcome), row.text("status")) << where;
  EXPECT_EQ(got.turning_points, static_cast<int>(row.number("turning_points"))) << where;
  const double slope = std::abs(row.number_or_blank("dRda").value_or(30)), scale = std::max(1.0, slope);
  const auto refraction = row.number_or_blank("refraction_arcsec");
  ASSERT_EQ(got.refraction_arcsec.has_value(), refraction.has_value()) << where;
  ++worst.rows;
  if (!refraction) return;
  const double miss = std::abs(*got.refraction_arcsec - *refraction) / scale;
  double &of_this_kind = got.outcome == f64::RAY_SPACE ? worst.refraction_arcsec : worst.ground_arcsec;
  of_this_kind = std::max(of_this_kind, miss);
  worst.height_m = std::max({worst.height_m, std::abs(got.min_height_m - row.number(columns.minimum)) / scale,
                             std::abs(got.max_height_m - row.number(columns.maximum)) / scale});
  worst.distance_m =
      std::max(worst.distance_m, std::abs(*got.ground_distance_m - row.number(columns.distance)) / scale);
  if (got.outcome == f64::RAY_SPACE)
    worst.beyond_claim =
        std::max(worst.beyond_claim, miss * scale - std::max(tolerance_arcsec, 1.2 * got.error_arcsec));
  if (got.outcome == f64::RAY_SPACE && columns.has_air_mass) {
    EXPECT_NEAR(*got.true_altitude_deg,
                row.number("apparent_altitude_deg") - to_deg(from_arcsec(*got.refraction_arcsec)), 1e-9);
    if (row.number_or_blank("air_mass"))
      worst.air_mass = std::max(worst.air_mass, std::abs(*got.air_mass / row.number("air_mass") - 1) / scale);
  }
}

/// Groups of rows with one profile and eye are one request of all their altitudes and wavelengths.
/// section: by the adaptive solver for air that varies along the surface, though it does not.
inline Worst compare_table(const std::string &file, Precision precision, RayMethod method,
                           const std::string &profile_name = "", const Columns &columns = {}, bool section = false) {
  const ReferenceTable table(file);
  std::map<std::pair<std::string, double>, std::vector<const ReferenceRow *>> groups;
  for (const ReferenceRow &row : table.rows()) {
    const std::string name = profile_name.empty() ? row.text("profile") : profile_name;
    if (name == "ciddor_humid" && file == "refraction_standard.csv") continue;  // another rule: see below
    groups[{name, row.number(columns.height)}].push_back(&row);
  }
  Worst worst;
  for (const auto &[key, rows] : groups) {
    std::set<double> altitudes, wavelengths;
    for (const ReferenceRow *row : rows) {
      altitudes.insert(row->number("apparent_altitude_deg"));
      wavelengths.insert(row->number(columns.wavelength));
    }
    RefractionRequest request;
    request.height_m = key.second;
    request.altitudes_deg.assign(altitudes.begin(), altitudes.end());
    request.wavelengths_nm.assign(wavelengths.begin(), wavelengths.end());
    request.precision = precision;
    request.method = method;
    request.section = section;
    request.tolerance_arcsec = precision == Precision::double_ ? 1e-5 : 0.02;
    const RefractionTable result = refraction_table(reference_profile(key.first), request, shared_device());
    EXPECT_EQ(result.rows.size(), altitudes.size() * wavelengths.size());
    for (const ReferenceRow *row : rows) {
      const auto altitude = altitudes.find(row->number("apparent_altitude_deg"));
      const auto wavelength = wavelengths.find(row->number(columns.wavelength));
      const auto i = static_cast<std::size_t>(std::distance(altitudes.begin(), altitude)) * wavelengths.size() +
                     static_cast<std::size_t>(std::distance(wavelengths.begin(), wavelength));
      SCOPED_TRACE(key.first);
      compare_row(*row, result.rows[i], columns, request.tolerance_arcsec, worst);
    }
  }
  return worst;
}

}  // namespace greenray::testing_data
