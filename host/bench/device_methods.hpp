// Our own kernels as methods of the benchmark.
#pragma once
#include <vector>

#include "bench/peer.hpp"
#include "compute/device.hpp"

namespace greenray::bench {

/// Both integrators, float and double, at the device's own lanes and at one, table as buffer and as image, along the
/// work-precision curve. few: one setting of each.
std::vector<Method> device_methods(const DeviceOptions &options, bool few);

/// "0:0 NAME (DRIVER)".
std::string device_words(const Device &device);

}  // namespace greenray::bench
