#include "compute/sampling_probe.hpp"

#include "compute/buffer.hpp"
#include "compute/program.hpp"

namespace greenray {

std::vector<std::array<float, 3>> device_samples(const std::shared_ptr<Device> &device, photon_twin::SampleKind kind,
                                                 float parameter, std::size_t count, std::uint32_t seed) {
  Device::State &state = device->state();
  std::vector<std::array<float, 3>> samples(count);
  Buffer<std::array<float, 3>> out(state, count, "samples");
  try {
    cl::Kernel kernel(build_program(state, {"probe_sampling"}), "probe_sampling");
    kernel.setArg(0, out.cl());
    kernel.setArg(1, static_cast<cl_int>(count));
    kernel.setArg(2, static_cast<cl_int>(kind));
    kernel.setArg(3, parameter);
    kernel.setArg(4, seed);
    state.queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange((count + 15) / 16 * 16), cl::NDRange(16));
    state.queue.finish();
  } catch (const cl::Error &error) {
    throw_failed_call(error, "kernel probe_sampling", state.info.name);
  }
  out.read(samples.data(), count);
  return samples;
}

std::vector<std::array<float, 3>> host_samples(photon_twin::SampleKind kind, float parameter, std::size_t count,
                                               std::uint32_t seed) {
  std::vector<std::array<float, 3>> samples;
  for (std::size_t i = 0; i < count; ++i) {
    const auto words = photon_twin::photon_words(seed, 0, static_cast<std::uint32_t>(i), 0, 0);
    const photon_twin::Vec3 s = photon_twin::sample_of_kind(kind, parameter, words);
    samples.push_back({s.x, s.y, s.z});
  }
  return samples;
}

}  // namespace greenray
