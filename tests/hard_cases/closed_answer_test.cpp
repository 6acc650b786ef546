// Flat media of straight pieces, n = n0 + g h: x = (q/g) [acosh(n/q)], q = n cos e, bending = change of elevation.
// Kinks every metre, jumps of a millimetre, ducts; drawn by a seeded generator, every number in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "render/refraction.hpp"
#include "support/angle.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

struct Answer {
  int outcome = f64::RAY_TRAPPED, turning_points = 0;
  long double bending_rad = 0, distance_m = 0, lowest_m = 0, highest_m = 0;
  long double smallest_sine = 1;  // at the knots passed: how near the ray came to another answer
};

long double index_at(const std::vector<IndexLevel> &rows, long double h) {
  std::size_t i = 0;
  while (i + 2 < rows.size() && h >= rows[i + 1].height_m) ++i;
  const long double width = static_cast<long double>(rows[i + 1].height_m) - rows[i].height_m;
  return 1 + rows[i].refractivity +
         (static_cast<long double>(rows[i + 1].refractivity) - rows[i].refractivity) / width * (h - rows[i].height_m);
}

/// acosh(b/q) - acosh(a/q), without cancellation: both are near their 0.
long double arc(long double a, long double b, long double q) {
  const long double sa = std::sqrt(std::max(0.0L, (a - q) * (a + q))),
                    sb = std::sqrt(std::max(0.0L, (b - q) * (b + q)));
  return std::log1p(((b - a) + (sb - sa)) / (a + sa));
}

/// Straight piece by straight piece, in long double.
Answer closed_answer(const std::vector<IndexLevel> &rows, long double eye_m, long double elevation_rad) {
  Answer a;
  a.lowest_m = a.highest_m = eye_m;
  bool up = elevation_rad > 0;
  const long double n_eye = index_at(rows, eye_m), q = n_eye * std::cos(elevation_rad);
  long double h = eye_m, n = n_eye, e = elevation_rad;
  bool low = false, high = false;
  std::size_t i = 0;
  while (i + 2 < rows.size() && (up ? h >= rows[i + 1].height_m : h > rows[i + 1].height_m)) ++i;
  for (;;) {
    const long double bottom = rows[i].height_m, top = rows[i + 1].height_m;
    const long double g = (static_cast<long double>(rows[i + 1].refractivity) - rows[i].refractivity) / (top - bottom);
    long double to = up ? top : bottom, n_to = 1 + (up ? rows[i + 1] : rows[i]).refractivity;
    const bool turns = n_to <= q;
    if (turns) {
      n_to = q;
      to = bottom + (q - 1 - rows[i].refractivity) / g;
      (up ? high : low) = true;
      ++a.turning_points;
    }
    const long double e_to = turns ? 0 : (up ? 1 : -1) * std::acos(std::min(1.0L, q / n_to));
    a.bending_rad += e - e_to;
    a.distance_m += g == 0 ? (to - h) / std::tan(e) : std::abs(q / g * arc(n, n_to, q));
    if (!turns) a.smallest_sine = std::min(a.smallest_sine, std::abs(std::sin(e_to)));
    h = to, n = n_to, e = e_to;
    a.lowest_m = std::min(a.lowest_m, h);
    a.highest_m = std::max(a.highest_m, h);
    if (turns && low && high) return a;
    if (turns) up = !up;
    else if (up ? i + 2 == rows.size() : i == 0) break;
    else i += up ? 1 : static_cast<std::size_t>(-1);
  }
  a.outcome = up ? f64::RAY_SPACE : f64::RAY_GROUND;
  return a;
}

/// 60 rows a metre apart with random steps, and among them three jumps within a millimetre.
std::vector<IndexLevel> drawn_medium(std::mt19937_64 &random) {
  std::normal_distribution<double> step(-1e-8, 3e-7);
  std::vector<IndexLevel> rows;
  double refractivity = 2.8e-4;
  for (int h = 0; h <= 60; ++h) {
    rows.push_back({static_cast<double>(h), refractivity, {}});
    if (h % 20 == 7) rows.push_back({h + 0.001, refractivity += 4 * step(random), {}});
    refractivity += step(random);
  }
  return rows;
}

template <class Twin>
class ClosedAnswer : public ::testing::Test {};
using Twins = ::testing::Types<Single, Double>;
TYPED_TEST_SUITE(ClosedAnswer, Twins);

TYPED_TEST(ClosedAnswer, FlatMediaWithKinksEveryMetreAndJumps) {
  // oracle: closed form in long double, rays that come no nearer than 1e-5 rad to grazing a knot
  // tolerance: of bending 1e-5 arcsec (double), 0.005 (float) over max(1, 1e-4 / smallest sine at a knot); distance
  // 1e-9
  //            (double) and 1e-6 (float) of it over the same
  std::mt19937_64 random(20041123);
  double worst_arcsec = 0, worst_distance = 0;
  int rows = 0, trapped = 0;
  for (int k = 0; k < 6; ++k) {
    ProfileSpec spec;
    spec.base_is_us76 = false;
    spec.index_levels = drawn_medium(random);
    const Profile profile(spec);
    RefractionRequest request;
    request.flat = true;
    request.height_m = std::uniform_real_distribution<double>(1, 59)(random);
    for (int i = 0; i < 60; ++i) request.altitudes_deg.push_back(std::normal_distribution<double>(0, 0.12)(random));
    request.wavelengths_nm = {550};
    request.precision = TypeParam::precision;
    request.tolerance_arcsec = TypeParam::is_double ? 1e-5 : 0.005;
    for (RayMethod method : {RayMethod::cells, RayMethod::dormand_prince}) {
      request.method = method;
      for (const RefractionRow &got : refraction_table(profile, request, shared_device()).rows) {
        const Answer want = closed_answer(spec.index_levels, request.height_m,
                                          static_cast<long double>(to_rad(1.0)) * got.apparent_altitude_deg);
        if (want.smallest_sine < 1e-5L) continue;
        const std::string where = "medium " + std::to_string(k) + ", eye " + std::to_string(request.height_m) + " m, " +
                                  std::to_string(got.apparent_altitude_deg) + " deg, method " +
                                  (method == RayMethod::cells ? "cells" : "rk");
        ASSERT_EQ(got.outcome, want.outcome) << where;
        ASSERT_EQ(got.turning_points, want.turning_points) << where;
        ++rows;
        if (want.outcome == f64::RAY_TRAPPED) {
          ++trapped;
          continue;
        }
        const double scale = std::max(1.0, 1e-4 / static_cast<double>(want.smallest_sine));
        const double miss = std::abs(*got.refraction_arcsec - to_arcsec(static_cast<double>(want.bending_rad)));
        worst_arcsec = std::max(worst_arcsec, miss / scale);
        worst_distance = std::max(worst_distance,
                                  std::abs(*got.ground_distance_m / static_cast<double>(want.distance_m) - 1) / scale);
        EXPECT_LE(miss, got.error_arcsec + 1e-7 * scale) << where << ": beyond its estimate";
      }
    }
  }
  EXPECT_GE(rows, 400);
  EXPECT_GE(trapped, 30);
  EXPECT_LT(worst_arcsec, TypeParam::is_double ? 1e-5 : 0.005);
  EXPECT_LT(worst_distance, TypeParam::is_double ? 1e-8 : 5e-6);
  std::cout << rows << " rays, " << trapped << " trapped; worst " << worst_arcsec << "\", distance " << worst_distance
            << "\n";
}

}  // namespace
}  // namespace greenray
