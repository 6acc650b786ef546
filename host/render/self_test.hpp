// Known-answer kernels: is this device's arithmetic sound?
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "compute/device.hpp"

namespace greenray {

struct SelfTestResult {
  std::string name;
  bool passed;
  std::string detail;
};

/// Curved rays against published refractions, storage paths against each other, struct layouts, random numbers.
std::vector<SelfTestResult> self_test(const std::shared_ptr<Device> &device);

}  // namespace greenray
