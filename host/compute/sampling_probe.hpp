// What a device draws: samples read back, for tests of their distributions.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "compute/device.hpp"
#include "twin/photon_twin.hpp"

namespace greenray {

/// `count` samples of one kind (kernels/lib/sampling_probe.h), those of photons 0, 1, 2 ...
std::vector<std::array<float, 3>> device_samples(const std::shared_ptr<Device> &device, photon_twin::SampleKind kind,
                                                 float parameter, std::size_t count, std::uint32_t seed);

/// The same from the host twin.
std::vector<std::array<float, 3>> host_samples(photon_twin::SampleKind kind, float parameter, std::size_t count,
                                               std::uint32_t seed);

}  // namespace greenray
