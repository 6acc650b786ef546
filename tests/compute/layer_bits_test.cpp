// The closed form on the device: the same bits whatever the work-group size and however the rays are split.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "atmosphere/layer_table.hpp"
#include "compute/layer_tracer.hpp"
#include "render/launch.hpp"
#include "support/angle.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

constexpr double eye_m = 45, error_arcsec = 1e-3;

/// Three wavelengths over standard air with an inversion: rays to space, to the ground and trapped.
const LayerTable &layers() {
  static const LayerTable made = [] {
    ProfileSpec spec;
    spec.inversions.push_back({8.0, 50.0, 5.0, {}});
    const IndexTable table = build_index_table(Profile(spec), {450, 550, 650}, {false, error_arcsec / 30, eye_m});
    const double flattened_m = f64::flattened_height_m(eye_m, table.curvature_per_m);
    return build_layer_table(table, place_layers(table, 0, flattened_m, error_arcsec), flattened_m,
                             {22000, 5000, 1200});
  }();
  return made;
}

std::vector<double> fan(std::size_t count) {
  std::mt19937 engine(2004);
  std::uniform_real_distribution<double> elevation_deg(-0.75, 0.75);
  std::vector<double> elevations;
  for (std::size_t i = 0; i < count; ++i) elevations.push_back(to_rad(elevation_deg(engine)));
  return elevations;
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

bool same_end(const f64::RayEnd &a, const f64::RayEnd &b) {
  bool same = a.outcome == b.outcome && a.turning_points == b.turning_points;
  for (auto field : {&f64::RayEnd::bending_rad, &f64::RayEnd::above_m, &f64::RayEnd::rise, &f64::RayEnd::run,
                     &f64::RayEnd::sigma_m, &f64::RayEnd::optical_path_m, &f64::RayEnd::min_z_m, &f64::RayEnd::max_z_m})
    same = same && same_bits(a.*field, b.*field);
  for (int k = 0; k < 3; ++k) same = same && same_bits(a.column[k], b.column[k]);
  return same;
}

void expect_same_ends(const std::vector<f64::RayEnd> &a, const std::vector<f64::RayEnd> &b) {
  ASSERT_EQ(a.size(), b.size());
  std::size_t differing = 0;
  for (std::size_t i = 0; i < a.size(); ++i) differing += same_end(a[i], b[i]) ? 0 : 1;
  EXPECT_EQ(differing, 0U) << "of " << a.size();
}

/// Calls use(part) for pieces of growing odd sizes, so that each ray comes to lie in another lane.
template <class Use>
void in_odd_pieces(std::span<const double> all, Use &&use) {
  for (std::size_t first = 0, size = 1; first < all.size(); first += size, size = size * 2 + 1)
    use(all.subspan(first, std::min(size, all.size() - first)));
}

template <class Twin>
class LayerBits : public ::testing::Test {};
using Twins = ::testing::Types<Single, Double>;
TYPED_TEST_SUITE(LayerBits, Twins);

TYPED_TEST(LayerBits, Trace) {
  // oracle: the same rays at once with local size 1
  // tolerance: exact
  const std::vector<double> elevations = fan(1003);
  for (int lanes : {1, 8}) {
    LayerTracer one(shared_device(lanes), layers(), TypeParam::precision, {}, 1);
    const auto expected = one.trace(elevations);
    for (int outcome : {f64::RAY_SPACE, f64::RAY_GROUND, f64::RAY_TRAPPED})
      ASSERT_GT(one.stats().outcomes[static_cast<std::size_t>(outcome)], 50U) << outcome;
    expect_same_ends(one.trace(elevations), expected);
    for (int local_size : {2, 16})
      expect_same_ends(
          LayerTracer(shared_device(lanes), layers(), TypeParam::precision, {}, local_size).trace(elevations),
          expected);
    std::vector<f64::RayEnd> parts;
    in_odd_pieces(elevations, [&](std::span<const double> some) {
      for (const f64::RayEnd &end : one.trace(some)) parts.push_back(end);
    });
    expect_same_ends(parts, expected);
  }
}

TYPED_TEST(LayerBits, TraceOverTheTracersOwnBatches) {
  // oracle: the same rays asked for in pieces smaller than a batch, which holds at most 65536 elevations
  // tolerance: exact
  const std::vector<double> elevations = fan(70001);
  LayerTracer tracer(shared_device(), layers(), TypeParam::precision);
  const auto whole = tracer.trace(elevations);
  std::vector<f64::RayEnd> parts;
  for (std::size_t first = 0; first < elevations.size(); first += 20003)
    for (const f64::RayEnd &end :
         tracer.trace(std::span(elevations).subspan(first, std::min<std::size_t>(20003, elevations.size() - first))))
      parts.push_back(end);
  expect_same_ends(parts, whole);
}

std::vector<double> distances(std::size_t count) {
  std::vector<double> all;
  for (std::size_t i = 1; i <= count; ++i) all.push_back(1e5 * static_cast<double>(i) / static_cast<double>(count));
  return all;
}

std::vector<f64::RayEnd> places_in_pieces(LayerTracer &tracer, std::span<const double> elevations,
                                          const std::vector<double> &distances_m) {
  std::vector<f64::RayEnd> parts;
  in_odd_pieces(elevations, [&](std::span<const double> some) {
    for (const f64::RayEnd &end : tracer.places(some, distances_m)) parts.push_back(end);
  });
  return parts;
}

TYPED_TEST(LayerBits, Places) {
  // oracle: the same places at once with local size 1
  // tolerance: exact
  const std::vector<double> elevations = fan(203), distances_m = distances(100);
  LayerTracer one(shared_device(), layers(), TypeParam::precision, {}, 1);
  const auto expected = one.places(elevations, distances_m);
  for (int local_size : {2, 16})
    expect_same_ends(
        LayerTracer(shared_device(), layers(), TypeParam::precision, {}, local_size).places(elevations, distances_m),
        expected);
  expect_same_ends(places_in_pieces(one, elevations, distances_m), expected);
}

TEST(LayerBitsFloat, PlacesOverTheTracersOwnBatches) {
  // oracle: the same places asked for in pieces smaller than a batch, which holds 2^20 of them
  // tolerance: exact
  const std::vector<double> elevations = fan(451), distances_m = distances(800);
  LayerTracer tracer(shared_device(), layers(), Precision::single_);
  expect_same_ends(places_in_pieces(tracer, elevations, distances_m), tracer.places(elevations, distances_m));
}

/// bending, outcome and turning points of a batch, [wavelengths][elevations].
template <class Scalar>
std::vector<double> bent(LayerTracer &tracer, std::span<const double> elevations) {
  BendBatch<Scalar> batch(tracer, elevations);
  batch.run();
  std::vector<double> all;
  for (std::size_t wave = 0; wave < 3; ++wave)
    for (std::size_t i = 0; i < elevations.size(); ++i) {
      all.push_back(static_cast<double>(batch.bending_rad(wave)[i]));
      all.push_back(batch.outcome(wave, i));
      all.push_back(batch.turning_points(wave, i));
    }
  return all;
}

TYPED_TEST(LayerBits, BendBatch) {
  // oracle: the same rays at once with local size 1
  // tolerance: exact
  using Scalar = typename TypeParam::Scalar;
  const std::vector<double> elevations = fan(1003);
  for (int lanes : {1, 8}) {
    LayerTracer one(shared_device(lanes), layers(), TypeParam::precision, {}, 1);
    const std::vector<double> expected = bent<Scalar>(one, elevations);
    EXPECT_EQ(bent<Scalar>(one, elevations), expected);
    for (int local_size : {2, 16}) {
      LayerTracer other(shared_device(lanes), layers(), TypeParam::precision, {}, local_size);
      EXPECT_EQ(bent<Scalar>(other, elevations), expected);
    }
    std::size_t first = 0;
    in_odd_pieces(elevations, [&](std::span<const double> some) {
      const std::vector<double> part = bent<Scalar>(one, some);
      for (std::size_t wave = 0; wave < 3; ++wave)
        EXPECT_TRUE(std::equal(part.begin() + static_cast<std::ptrdiff_t>(wave * some.size() * 3),
                               part.begin() + static_cast<std::ptrdiff_t>((wave + 1) * some.size() * 3),
                               expected.begin() + static_cast<std::ptrdiff_t>((wave * elevations.size() + first) * 3)));
      first += some.size();
    });
  }
}

}  // namespace
}  // namespace greenray
