// The kernels of rays on a handful of them: what `ctest -L oclgrind` runs under the simulator.
#include <gtest/gtest.h>

#include <cmath>

#include "atmosphere/layer_table.hpp"
#include "atmosphere/profile_file.hpp"
#include "compute/layer_tracer.hpp"
#include "compute/section_tracer.hpp"
#include "render/launch.hpp"
#include "render/section_rays.hpp"
#include "support/angle.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

const std::vector<double> elevations_rad{to_rad(30), to_rad(45), to_rad(60)};

/// Laplace's two terms (Smart, Textbook on Spherical Astronomy, section 38): they hold whatever the air's structure.
double laplace_rad(double elevation_rad) {
  const double t = 1 / std::tan(elevation_rad), refractivity = Profile(ProfileSpec{}).refractivity(0, 550).value,
               beta = 8434.5 / 6371000;  // height of a homogeneous air at 288.15 K over the Earth's radius
  return refractivity * ((1 - beta) * t - (beta - refractivity / 2) * t * t * t);
}

const IndexTable &table() {
  static const IndexTable made = build_index_table(Profile(ProfileSpec{}), {550}, {false, 0.1, 0});
  return made;
}

void expect_laplace(const std::vector<f64::RayEnd> &ends) {
  ASSERT_EQ(ends.size(), elevations_rad.size());
  for (std::size_t i = 0; i < ends.size(); ++i) {
    EXPECT_EQ(ends[i].outcome, f64::RAY_SPACE);
    EXPECT_NEAR(to_arcsec(ends[i].bending_rad), to_arcsec(laplace_rad(elevations_rad[i])), 0.03) << i;
  }
}

// oracle: Laplace's formula
// tolerance: its third term at 30 degrees and the humidity of none: 0.02"; 0.01" for floats
TEST(TinyRays, InClosedForm) {
  const LayerTable layers = build_layer_table(table(), place_layers(table(), 0, 0, 0.1), 0, {22000, 5000, 1200});
  for (const int lanes : {0, 1})
    expect_laplace(LayerTracer(shared_device(lanes), layers, Precision::single_).trace(elevations_rad));
}

// oracle: what is straight within 0.1 m over a kilometre: height = distance times the tangent of the elevation
// tolerance: bending of 1 km at 30 degrees and more, 0.05 m, the Earth's curvature, 0.08 m
TEST(TinyRays, PlacesInClosedForm) {
  const LayerTable layers = build_layer_table(table(), place_layers(table(), 0, 0, 0.1), 0, {22000, 5000, 1200});
  const std::vector<double> distances_m{500, 1000};
  for (const int lanes : {0, 1}) {
    const auto ends = LayerTracer(shared_device(lanes), layers, Precision::single_).places(elevations_rad, distances_m);
    ASSERT_EQ(ends.size(), 6U);
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(ends[i].above_m / (distances_m[i % 2] * std::tan(elevations_rad[i / 2])), 1, 3e-4) << i;
  }
}

void expect_laplace_by_steps(Integrator integrator, TableStorage storage) {
  std::vector<f64::RayStart> starts;
  for (const double e : elevations_rad) starts.push_back(launch(table(), 0, 0, e));
  TraceOptions options;
  options.precision = Precision::single_;
  options.integrator = integrator;
  options.storage = storage;
  options.tolerance_rad = 1e-8;
  for (const int lanes : {0, 1}) expect_laplace(RayTracer(shared_device(lanes), table(), options).trace(starts));
}

// oracle, tolerance: as above
TEST(TinyRays, BySteps) { expect_laplace_by_steps(Integrator::dormand_prince, TableStorage::buffer); }
TEST(TinyRays, ByRichardsonsSteps) { expect_laplace_by_steps(Integrator::richardson, TableStorage::buffer); }
// Not under the simulator: oclgrind 21.10 takes all that is read from an image for uninitialised.
TEST(TinyRayImage, FromAnImage) { expect_laplace_by_steps(Integrator::dormand_prince, TableStorage::image); }

// oracle: Laplace's formula, where an inversion that moves is too weak to be seen
// tolerance: as above
TEST(TinyRays, ThroughAirThatVaries) {
  const AirSection air(parse_profile(
      "air.toml",
      "[[inversion]]\ndelta_T_K = { x_m = [0, 1e5], value = [1e-6, 0] }\nheight_m = 50\ndiffuseness_m = 5\n"));
  const SectionTable section = build_section_table(section_medium(air, false), {550}, {1, 0});
  std::vector<f64_section::RayStart> starts;
  for (const double e : elevations_rad) starts.push_back(launch(section, 0, {0, 0}, e));
  TraceOptions options;
  options.precision = Precision::single_;
  options.tolerance_rad = 1e-8;
  for (const int lanes : {0, 1}) {
    const auto ends = SectionTracer(shared_device(lanes), section, options).trace(starts);
    for (std::size_t i = 0; i < ends.size(); ++i)
      EXPECT_NEAR(to_arcsec(ends[i].bending_rad), to_arcsec(laplace_rad(elevations_rad[i])), 0.03) << i;
  }
}

}  // namespace
}  // namespace greenray
