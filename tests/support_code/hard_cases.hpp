// Holds refraction tables against tests/data/reference/hard: status, turning points, error, and the error claimed.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "render/refraction.hpp"
#include "support/angle.hpp"
#include "support_code/reference_table.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray::testing_data {

inline const Profile &hard_profile(const std::string &name) {
  return reference_profile(name == "us76" ? name : "../hard/profiles/" + name);
}

/// What a row must meet, [arcsec] and [m], all over max(1, |dR/da|).
struct Bars {
  double refraction_arcsec, height_m, distance_m;
  double edge_deg = 1e-6;  // nearer than this to an edge, the answer of either side is right
};

/// Errors of a whole table, each row's beside its estimate; failures in words, worst first.
class HardCases {
 public:
  HardCases(Precision precision, RayMethod method, double tolerance_arcsec, Bars bars)
      : precision_(precision), method_(method), tolerance_arcsec_(tolerance_arcsec), bars_(bars) {}

  /// Every `stride`th air and eye of a table.
  void run(const std::string &file, std::size_t stride = 1) {
    const ReferenceTable table("hard/" + file + ".csv");
    std::map<std::tuple<std::string, double, double>, std::vector<const ReferenceRow *>> groups;
    for (const ReferenceRow &row : table.rows())
      groups[{row.text("profile"), row.number("height_m"), stretch_class(row)}].push_back(&row);
    std::size_t i = 0;
    std::pair<std::string, double> last = {std::get<0>(groups.begin()->first), std::get<1>(groups.begin()->first)};
    for (const auto &[key, rows] : groups) {
      const std::pair<std::string, double> eye{std::get<0>(key), std::get<1>(key)};
      i += eye != last;
      last = eye;
      if (i % stride == 0) ask(eye.first, eye.second, std::get<2>(key), rows);
    }
  }

  int rows() const { return rows_; }
  double worst_arcsec() const { return worst_arcsec_; }

  /// Fails the test for each kind of failure, the worst rows of it named with the command that shows them.
  void report(const std::string &title) {
    for (auto &[kind, list] : failures_) {
      std::sort(list.begin(), list.end(), [](const auto &a, const auto &b) { return a.first > b.first; });
      std::ostringstream text;
      text << title << ": " << list.size() << " of " << rows_ << " rows: " << kind << "\n";
      for (std::size_t i = 0; i < std::min<std::size_t>(list.size(), shown()); ++i)
        text << "    " << list[i].second << "\n";
      ADD_FAILURE() << text.str();
    }
    print_effectivity(title);
  }

 private:
  static std::size_t shown() { return std::getenv("GREENRAY_HARD_CASES_SHOWN") ? 1000 : 4; }

  /// A tolerance is absolute, and a ray whose refraction changes a million times faster than its direction cannot keep
  /// 1e-5 arcsec: such rows are asked apart, with a hundred times the tolerance.
  static double stretch_class(const ReferenceRow &row) {
    const double stretch = std::abs(row.number_or_blank("dRda").value_or(1));
    return stretch < 100 ? 1 : 100;
  }

  void ask(const std::string &air, double eye_m, double stretch, const std::vector<const ReferenceRow *> &rows) {
    std::set<double> altitudes, wavelengths;
    for (const ReferenceRow *row : rows) {
      altitudes.insert(row->number("apparent_altitude_deg"));
      wavelengths.insert(row->number("wavelength_nm"));
    }
    RefractionRequest request;
    request.height_m = eye_m;
    request.altitudes_deg.assign(altitudes.begin(), altitudes.end());
    request.wavelengths_nm.assign(wavelengths.begin(), wavelengths.end());
    request.precision = precision_;
    request.method = method_;
    request.tolerance_arcsec = tolerance_arcsec_ * stretch;
    const RefractionTable result = refraction_table(hard_profile(air), request, shared_device());
    ASSERT_EQ(result.rows.size(), altitudes.size() * wavelengths.size());
    for (const ReferenceRow *row : rows) {
      const auto a = std::distance(altitudes.begin(), altitudes.find(row->number("apparent_altitude_deg")));
      const auto w = std::distance(wavelengths.begin(), wavelengths.find(row->number("wavelength_nm")));
      compare(*row, result.rows[static_cast<std::size_t>(a) * wavelengths.size() + static_cast<std::size_t>(w)]);
    }
  }

  void compare(const ReferenceRow &row, const RefractionRow &got) {
    ++rows_;
    const std::string status = outcome_name(got.outcome);
    const bool at_edge = row.number("edge_deg") < bars_.edge_deg;
    if (got.outcome != f64::RAY_SPACE && got.outcome != f64::RAY_GROUND && got.outcome != f64::RAY_TRAPPED)
      return fail("no outcome", 1, row, "got " + status);
    const bool numbers = got.refraction_arcsec.has_value();
    if (numbers == (got.outcome == f64::RAY_TRAPPED) ||
        (numbers && !(std::isfinite(*got.refraction_arcsec) && std::isfinite(*got.ground_distance_m))) ||
        !std::isfinite(got.min_height_m) || !std::isfinite(got.max_height_m) || !(got.error_arcsec >= 0))
      return fail("a number is missing, not finite or superfluous", 1, row, "status " + status);
    const bool same = status == row.text("status");
    if (!same && !at_edge) return fail("wrong status", 1, row, "got " + status + ", oracle " + row.text("status"));
    const int turning = static_cast<int>(row.number("turning_points"));
    if (got.turning_points != turning && same && !at_edge)
      fail("wrong number of turning points", 1, row,
           "got " + std::to_string(got.turning_points) + ", oracle " + std::to_string(turning));
    if (!same || got.turning_points != turning || !numbers) return;
    // So close to an edge float does not know the direction, and steps land on the edge to their tolerance only.
    const bool knows_edges = precision_ == Precision::double_ && method_ == RayMethod::cells;
    if (at_edge && !knows_edges) return;
    compare_numbers(row, got);
  }

  void compare_numbers(const ReferenceRow &row, const RefractionRow &got) {
    const double scale = std::max(1.0, std::abs(row.number("dRda")));
    const double unsure = 2 * row.number("oracle_arcsec") + 3e-8 * scale;  // hard/README.md: a third route in 36 digits
    // Within this of the horizontal a ray from above the air goes further: space begins a centimetre above the eye.
    const double eye_m = row.number("height_m"), sine = std::sin(to_rad(row.number("apparent_altitude_deg")));
    const double beyond_m = eye_m >= 120000 ? std::min(700.0, 0.03 / std::max(1e-9, std::abs(sine))) : 0;
    const double height_bar_m = std::max(bars_.height_m, eye_m * (precision_ == Precision::double_ ? 1e-8 : 1e-6));
    const double miss = std::abs(*got.refraction_arcsec - row.number("refraction_arcsec"));
    const double known = std::max(0.0, miss - unsure) / scale;
    worst_arcsec_ = std::max(worst_arcsec_, known);
    const auto against = [&](double found, double bar) {
      std::ostringstream text;
      text << found << " over " << bar << " (|dR/da| " << scale << ", refraction " << *got.refraction_arcsec
           << ", oracle " << row.text("refraction_arcsec") << ", edge " << row.text("edge_deg") << " deg, "
           << row.text("status") << ")";
      return text.str();
    };
    if (known > bars_.refraction_arcsec)
      fail("refraction [arcsec over |dR/da|]", known, row, against(known, bars_.refraction_arcsec));
    const double low = std::abs(got.min_height_m - row.number("min_height_m")) / scale;
    const double high = std::abs(got.max_height_m - row.number("max_height_m")) / scale;
    if (std::max(low, high) > height_bar_m)
      fail("lowest or highest point [m over |dR/da|]", std::max(low, high), row,
           against(std::max(low, high), height_bar_m));
    const double distance = std::abs(*got.ground_distance_m - row.number("ground_distance_m")) / scale;
    const double reach = std::max(1.0, row.number("ground_distance_m") * 1e-6);
    if (distance > bars_.distance_m * reach + beyond_m)
      fail("ground distance [m over |dR/da|]", distance, row, against(distance, bars_.distance_m * reach));
    if (miss > got.error_arcsec + unsure)
      fail("error beyond its estimate [times]", (miss - unsure) / std::max(got.error_arcsec, 1e-12), row,
           against(miss, got.error_arcsec));
    if (miss > 5 * unsure) effectivity_.push_back(got.error_arcsec / miss);
    estimates_.push_back(got.error_arcsec / scale);
  }

  void fail(const std::string &kind, double size, const ReferenceRow &row, const std::string &what) {
    std::ostringstream text;
    text << "greenray refraction " << row.text("profile") << ".toml --height " << row.text("height_m")
         << " --altitudes " << row.text("apparent_altitude_deg") << " --wavelengths " << row.text("wavelength_nm")
         << " --precision " << (precision_ == Precision::double_ ? "double" : "float") << " --method "
         << method_name(method_) << " --tolerance " << tolerance_arcsec_ * stretch_class(row) << " : " << what;
    failures_[kind].emplace_back(size, text.str());
  }

  static double quantile(std::vector<double> v, double q) {
    std::sort(v.begin(), v.end());
    return v.empty() ? 0 : v[static_cast<std::size_t>(q * static_cast<double>(v.size() - 1))];
  }

  void print_effectivity(const std::string &title) const {
    std::cout << std::setprecision(3) << title << ": " << rows_ << " rows, worst error " << worst_arcsec_
              << "\" over |dR/da|; estimate/true of " << effectivity_.size() << " rows: min "
              << quantile(effectivity_, 0) << ", 1 % " << quantile(effectivity_, 0.01) << ", 10 % "
              << quantile(effectivity_, 0.1) << ", median " << quantile(effectivity_, 0.5) << ", 90 % "
              << quantile(effectivity_, 0.9) << ", max " << quantile(effectivity_, 1)
              << "; estimate over |dR/da|: median " << quantile(estimates_, 0.5) << "\", 99 % "
              << quantile(estimates_, 0.99) << "\"\n";
  }

  Precision precision_;
  RayMethod method_;
  double tolerance_arcsec_;
  Bars bars_;
  int rows_ = 0;
  double worst_arcsec_ = 0;
  std::vector<double> effectivity_, estimates_;
  std::map<std::string, std::vector<std::pair<double, std::string>>> failures_;
};

}  // namespace greenray::testing_data
