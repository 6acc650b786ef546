// Single device functions, struct layouts and random numbers, read back from a device: for tests and the self-test.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "compute/device.hpp"
#include "twin/twin.hpp"

namespace greenray {

/// Every device function once per input, with the lanes the device would use.
std::vector<f32::ProbeOutput> probe_functions(const std::shared_ptr<Device> &device,
                                              std::span<const f32::ProbeInput> inputs, const f32::Absorbers &absorbers);
std::vector<f64::ProbeOutput> probe_functions(const std::shared_ptr<Device> &device,
                                              std::span<const f64::ProbeInput> inputs, const f64::Absorbers &absorbers);

/// Sizes of IndexCell, RayStart, RayEnd, Absorbers and offsets of density, row, column, outcome as the device sees
/// them.
std::array<int, 8> device_layout(const std::shared_ptr<Device> &device, bool real_is_double);
/// The same from the host compiler.
std::array<int, 8> host_layout(bool real_is_double);

/// Philox words for (counter[4], key[2]) rows.
std::vector<std::array<std::uint32_t, 4>> random_words(const std::shared_ptr<Device> &device,
                                                       std::span<const std::array<std::uint32_t, 6>> rows);

}  // namespace greenray
