// Radii that do not reach over edges.
#include "render/radius_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "twin/photon_twin.hpp"

namespace greenray {
namespace {

std::vector<GatherPoint> floor_points(std::size_t columns, std::size_t rows, std::size_t samples, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<float> in(0, 1);
  std::vector<GatherPoint> points;
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t x = 0; x < columns; ++x)
      for (std::size_t s = 0; s < samples; ++s)
        points.push_back({{static_cast<float>(x) + in(engine), static_cast<float>(y) + in(engine), 0},
                          photon_twin::pack_normal(0, 0, 1)});
  return points;
}

double distance_m(const GatherPoint &a, const GatherPoint &b) {
  return std::hypot(static_cast<double>(a.place_m[0] - b.place_m[0]), static_cast<double>(a.place_m[1] - b.place_m[1]),
                    static_cast<double>(a.place_m[2] - b.place_m[2]));
}

// oracle: the lower envelope min_j (r_j + slope d_ij) over all pairs, by brute force
// tolerance: none below it (rounding 1e-5); above it by what steps from pixel to pixel go around: 12 % of the distance
TEST(RadiusField, IsTheLowerEnvelope) {
  const std::vector<GatherPoint> points = floor_points(12, 9, 3, 1);
  std::mt19937 engine(2);
  std::vector<float> radius;
  for (std::size_t i = 0; i < points.size(); ++i) radius.push_back(i % 7 == 0 ? 0.2f : 5.0f);
  std::vector<float> limited = radius;
  limit_radius_slope(points, 12, 3, 0.3, limited);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double envelope = 1e9, reach = 0;
    for (std::size_t j = 0; j < points.size(); ++j) {
      const double bound = static_cast<double>(radius[j]) + 0.3 * distance_m(points[i], points[j]);
      if (bound < envelope) envelope = bound, reach = distance_m(points[i], points[j]);
    }
    EXPECT_GE(static_cast<double>(limited[i]), envelope - 1e-5);
    EXPECT_LE(static_cast<double>(limited[i]), envelope + 0.3 * 0.12 * reach + 1e-5);
  }
}

// oracle: a wall at a right angle is no neighbour, nor is anything when there is no picture
// tolerance: none
TEST(RadiusField, LeavesOtherSidesAlone) {
  std::vector<GatherPoint> points = floor_points(4, 1, 1, 3);
  points[1].normal = photon_twin::pack_normal(1, 0, 0);
  const std::vector<float> radius{0.1f, 3.0f, 0.1f, 3.0f};
  std::vector<float> limited = radius;
  limit_radius_slope(points, 4, 1, 0.2, limited);
  EXPECT_EQ(limited[1], 3.0f);
  EXPECT_LT(limited[3], 1.0f);
  limited = radius;
  limit_radius_slope(points, 0, 1, 0.2, limited);
  EXPECT_EQ(limited, radius);
}

// oracle: the least of a place's own radius and those around it that face the same way, each with its distance's share
// tolerance: rounding
TEST(RadiusField, LaterPlacesAreLimitedByThoseAroundThem) {
  std::vector<GatherPoint> others = floor_points(6, 5, 2, 3);
  for (std::size_t i = 0; i < others.size(); i += 5) others[i].normal = photon_twin::pack_normal(1, 0, 0);
  const std::vector<GatherPoint> places = floor_points(6, 5, 1, 4);
  std::mt19937 engine(5);
  std::uniform_real_distribution<float> size(0.1f, 3.0f);
  std::vector<float> other_radius, radius;
  for (std::size_t i = 0; i < others.size(); ++i) other_radius.push_back(size(engine));
  for (std::size_t i = 0; i < places.size(); ++i) radius.push_back(size(engine));
  std::vector<std::size_t> around;
  for (std::size_t i = 0; i < places.size(); ++i)
    for (int k = 0; k < 7; ++k) around.push_back(k == 0 ? ~std::size_t{0} : engine() % others.size());
  std::vector<float> limited = radius;
  limit_radii_beside(places, limited, others, other_radius, around, 0.3);
  bool any = false;
  for (std::size_t i = 0; i < places.size(); ++i) {
    double expected = static_cast<double>(radius[i]);
    for (std::size_t k = 7 * i + 1; k < 7 * i + 7; ++k)
      if (around[k] % 5 != 0)
        expected = std::min(
            expected, static_cast<double>(other_radius[around[k]]) + 0.3 * distance_m(places[i], others[around[k]]));
    EXPECT_NEAR(static_cast<double>(limited[i]), expected, 1e-5) << i;
    any = any || limited[i] < radius[i];
  }
  EXPECT_TRUE(any);
}

}  // namespace
}  // namespace greenray
