// Bending and outcome alone, in memory that device and host share where they can.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "compute/layer_tracer_state.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

constexpr std::size_t groups_per_item = 64;  // of LANES rays: a work-item then lasts some microseconds

struct Free {
  void operator()(void *p) const { std::free(p); }
};

/// Page-aligned memory that an OpenCL buffer uses in place.
template <class T>
struct SharedArray {
  SharedArray(const Device::State &device, std::size_t count, cl_mem_flags access)
      : bytes((count * sizeof(T) + 4095) / 4096 * 4096), data(static_cast<T *>(std::aligned_alloc(4096, bytes))) {
    if (!data) throw MemoryError("no memory for " + std::to_string(count) + " rays");
    std::fill_n(data.get(), count, T{});
    buffer = cl::Buffer(device.context, access | CL_MEM_USE_HOST_PTR, bytes, data.get());
  }
  /// Makes the device's writes seen here; until the next launch.
  void *map(const cl::CommandQueue &queue, cl_map_flags flags) {
    return queue.enqueueMapBuffer(buffer, CL_TRUE, flags, 0, bytes);
  }
  std::size_t bytes;
  std::unique_ptr<T, Free> data;
  cl::Buffer buffer;
};

}  // namespace

template <class Scalar>
struct BendBatch<Scalar>::State {
  State(LayerTracer::State &t, std::span<const double> elevations_rad)
      : tracer(t),
        count(elevations_rad.size()),
        groups((std::max<std::size_t>(count, 1) + t.lanes() - 1) / t.lanes()),
        stride(groups * t.lanes()),
        memory(t.device, (stride * (1 + t.rows)) * sizeof(Scalar) + stride * t.rows, "rays to bend"),
        sines(t.device, stride, CL_MEM_READ_ONLY),
        bending(t.device, stride * t.rows, CL_MEM_WRITE_ONLY),
        status(t.device, stride * t.rows, CL_MEM_WRITE_ONLY),
        kernel(t.kernel("bend_rays", false, static_cast<int>(groups_per_item))) {
    for (std::size_t i = 0; i < stride; ++i)
      sines.data.get()[i] = count ? static_cast<Scalar>(std::sin(elevations_rad[std::min(i, count - 1)])) : Scalar{0};
    kernel.setArg(5, sines.buffer);
    kernel.setArg(6, bending.buffer);
    kernel.setArg(7, status.buffer);
    kernel.setArg(8, static_cast<cl_int>(groups));
  }

  void run() {
    try {
      const cl::CommandQueue &queue = tracer.device.queue;
      queue.enqueueUnmapMemObject(sines.buffer, sines.map(queue, CL_MAP_WRITE));
      seconds = tracer.launch(kernel, (groups + groups_per_item - 1) / groups_per_item);
      queue.enqueueUnmapMemObject(bending.buffer, bending.map(queue, CL_MAP_READ));
      queue.enqueueUnmapMemObject(status.buffer, status.map(queue, CL_MAP_READ));
      queue.finish();
    } catch (const cl::Error &error) {
      throw_failed_call(error, "kernel bend_rays", tracer.device.info.name);
    }
  }

  LayerTracer::State &tracer;
  std::size_t count, groups, stride;
  Reservation memory;
  SharedArray<Scalar> sines, bending;
  SharedArray<std::uint8_t> status;
  cl::Kernel kernel;
  double seconds = 0;
};

template <class Scalar>
BendBatch<Scalar>::BendBatch(LayerTracer &tracer, std::span<const double> elevations_rad) {
  if (tracer.state_->is_double() != (sizeof(Scalar) == sizeof(double)))
    throw RunError("a batch of rays has another precision than its tracer");
  state_ = std::make_unique<State>(*tracer.state_, elevations_rad);
}
template <class Scalar>
BendBatch<Scalar>::~BendBatch() = default;
template <class Scalar>
void BendBatch<Scalar>::run() {
  state_->run();
}
template <class Scalar>
std::span<const Scalar> BendBatch<Scalar>::bending_rad(std::size_t wavelength) const {
  return {state_->bending.data.get() + wavelength * state_->stride, state_->count};
}
template <class Scalar>
int BendBatch<Scalar>::outcome(std::size_t wavelength, std::size_t elevation) const {
  return state_->status.data.get()[wavelength * state_->stride + elevation] & ((1 << f64::LAYER_STATUS_TURNS) - 1);
}
template <class Scalar>
int BendBatch<Scalar>::turning_points(std::size_t wavelength, std::size_t elevation) const {
  return state_->status.data.get()[wavelength * state_->stride + elevation] >> f64::LAYER_STATUS_TURNS;
}
template <class Scalar>
double BendBatch<Scalar>::kernel_seconds() const {
  return state_->seconds;
}

template class BendBatch<float>;
template class BendBatch<double>;

}  // namespace greenray
