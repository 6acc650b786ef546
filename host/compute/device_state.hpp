// The OpenCL side of a Device; included by host/compute only.
#pragma once
#include <map>
#include <string>

#include "compute/device.hpp"
#include "compute/opencl.hpp"

namespace greenray {

struct Device::State {
  DeviceInfo info;
  LanePlan lanes;
  DeviceOptions options;
  cl::Device device;
  cl::Context context;
  cl::CommandQueue queue;
  std::size_t budget_bytes = 0, used_bytes = 0;
  double compile_seconds = 0;
  std::map<std::string, cl::Program> programs;  // by options and entry file
  std::map<std::string, cl::Kernel> kernels;    // that have run once, by the same: another picture need not warm up
};

}  // namespace greenray
