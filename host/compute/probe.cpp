#include "compute/probe.hpp"

#include <cstddef>

#include "compute/buffer.hpp"
#include "compute/program.hpp"

namespace greenray {
namespace {

void launch(Device::State &device, cl::Kernel &kernel, std::size_t count, const std::string &name) {
  try {
    device.queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(count), cl::NDRange(1));
    device.queue.finish();
  } catch (const cl::Error &error) {
    throw_failed_call(error, "kernel " + name, device.info.name);
  }
}

template <class Input, class Output, class Absorbers>
std::vector<Output> probe_all(Device::State &device, std::span<const Input> inputs, const Absorbers &absorbers,
                              bool real_is_double) {
  const int lanes = real_is_double ? device.lanes.lanes_double : device.lanes.lanes_float;
  Buffer<Input> in(device, inputs.size(), "probe inputs");
  Buffer<Output> out(device, inputs.size(), "probe outputs");
  in.write(inputs.data(), inputs.size());
  cl::Kernel kernel(build_program(device, {"probe", lanes, real_is_double, false, false, true}), "probe_functions");
  kernel.setArg(0, in.cl());
  kernel.setArg(1, out.cl());
  kernel.setArg(2, static_cast<cl_int>(inputs.size()));
  kernel.setArg(3, absorbers);
  launch(device, kernel, inputs.size(), "probe_functions");
  std::vector<Output> outputs(inputs.size());
  out.read(outputs.data(), outputs.size());
  return outputs;
}

}  // namespace

std::vector<f32::ProbeOutput> probe_functions(const std::shared_ptr<Device> &device,
                                              std::span<const f32::ProbeInput> inputs,
                                              const f32::Absorbers &absorbers) {
  return probe_all<f32::ProbeInput, f32::ProbeOutput>(device->state(), inputs, absorbers, false);
}

std::vector<f64::ProbeOutput> probe_functions(const std::shared_ptr<Device> &device,
                                              std::span<const f64::ProbeInput> inputs,
                                              const f64::Absorbers &absorbers) {
  return probe_all<f64::ProbeInput, f64::ProbeOutput>(device->state(), inputs, absorbers, true);
}

std::array<int, 8> device_layout(const std::shared_ptr<Device> &device, bool real_is_double) {
  Device::State &state = device->state();
  Buffer<int> out(state, 8, "struct layout");
  cl::Kernel kernel(build_program(state, {"probe", 1, real_is_double, false, false, true}), "probe_layout");
  kernel.setArg(0, out.cl());
  launch(state, kernel, 1, "probe_layout");
  std::array<int, 8> layout{};
  out.read(layout.data(), 8);
  return layout;
}

template <class Cell, class Start, class End, class Absorbers>
static std::array<int, 8> layout_of() {
  return {static_cast<int>(sizeof(Cell)),
          static_cast<int>(sizeof(Start)),
          static_cast<int>(sizeof(End)),
          static_cast<int>(sizeof(Absorbers)),
          static_cast<int>(offsetof(Cell, density)),
          static_cast<int>(offsetof(Start, row)),
          static_cast<int>(offsetof(End, column)),
          static_cast<int>(offsetof(End, outcome))};
}

std::array<int, 8> host_layout(bool real_is_double) {
  return real_is_double ? layout_of<f64::IndexCell, f64::RayStart, f64::RayEnd, f64::Absorbers>()
                        : layout_of<f32::IndexCell, f32::RayStart, f32::RayEnd, f32::Absorbers>();
}

std::vector<std::array<std::uint32_t, 4>> random_words(const std::shared_ptr<Device> &device,
                                                       std::span<const std::array<std::uint32_t, 6>> rows) {
  Device::State &state = device->state();
  Buffer<std::array<std::uint32_t, 6>> in(state, rows.size(), "random counters");
  Buffer<std::array<std::uint32_t, 4>> out(state, rows.size(), "random words");
  in.write(rows.data(), rows.size());
  cl::Kernel kernel(build_program(state, {"probe", 1, false, false, false, true}), "probe_random");
  kernel.setArg(0, in.cl());
  kernel.setArg(1, out.cl());
  kernel.setArg(2, static_cast<cl_int>(rows.size()));
  launch(state, kernel, rows.size(), "probe_random");
  std::vector<std::array<std::uint32_t, 4>> words(rows.size());
  out.read(words.data(), words.size());
  return words;
}

}  // namespace greenray
