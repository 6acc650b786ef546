// Our own kernels as methods of the benchmark.
#pragma once
#include <vector>

#include "atmosphere/layer_table.hpp"
#include "bench/peer.hpp"
#include "compute/device.hpp"
#include "compute/ray_tracer.hpp"

namespace greenray::bench {

/// The closed form, both integrators, float and double, at the device's own lanes and at one, table as buffer and as
/// image, along the work-precision curve. few: one setting of each.
std::vector<Method> device_methods(const DeviceOptions &options, bool few);

/// One setting each: layers in closed form to an error, Dormand-Prince in float at its middle setting.
Method closed_form_method(const std::shared_ptr<Device> &device, Precision precision, double error_arcsec);
Method stepping_method(const std::shared_ptr<Device> &device);

/// What the closed form needs for rays that start at one height: its layers, weighed on a table that is
/// layers_per_table times finer than their own error, and the elevations of the first row.
inline constexpr double layers_per_table = 30;
LayerTable layers_for(const IndexTable &table, double error_arcsec, std::span<const f64::RayStart> starts);
std::vector<double> elevations_of(std::span<const f64::RayStart> starts);

/// "0:0 NAME (DRIVER)".
std::string device_words(const Device &device);

}  // namespace greenray::bench
