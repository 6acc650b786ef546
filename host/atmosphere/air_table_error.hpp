// The error of an air table, by test paths through it and through a finer one. Of build_air_table.
#pragma once
#include <vector>

#include "atmosphere/air_table.hpp"

namespace greenray {

/// Where a test path starts.
struct TestPath {
  double height_m, elevation_rad;
};

/// From between the edges (kinks of the medium, ascending), level to steep, up and down. A level path on a kink itself
/// may go either way.
std::vector<TestPath> test_fan(const std::vector<double> &edges_m);

/// Largest difference of heights along the paths, at sixteen places each [m], over how much a path amplifies an error
/// of its direction where that is more than 1.
double largest_difference_m(const AirTable &coarse, const AirTable &fine, const std::vector<TestPath> &fan,
                            double length_m);

}  // namespace greenray
