#include "compute/layer_tracer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "compute/buffer.hpp"
#include "compute/program.hpp"
#include "compute/ray_end.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

constexpr std::size_t most_elevations = std::size_t{1} << 16;  // of one launch

template <class Layer>
void append_side(std::vector<Layer> &out, const LayerSide &side) {
  using Scalar = decltype(Layer::lift);
  const auto narrow = [](double x) { return static_cast<Scalar>(x); };
  for (const LayerData &data : side.layers) {
    Layer layer;
    layer.lift = narrow(data.lift), layer.bulge = narrow(data.bulge), layer.skew = narrow(data.skew);
    layer.far_m = narrow(data.far_m);
    std::transform(data.mean.begin(), data.mean.end(), layer.mean, narrow);
    std::transform(data.tilt.begin(), data.tilt.end(), layer.tilt, narrow);
    std::transform(data.bow.begin(), data.bow.end(), layer.bow, narrow);
    out.push_back(layer);
  }
}

}  // namespace

/// The device's side in one precision.
struct LayerTracer::State {
  State(std::shared_ptr<Device> d, const LayerTable &table, Precision p)
      : owner(std::move(d)),
        device(owner->state()),
        precision(p),
        rows(table.wavelength_nm.size()),
        layers_above(static_cast<int>(table.above.front().layers.size())),
        layers_below(static_cast<int>(table.below.front().layers.size())) {
    if (is_double() && !device.info.has_double)
      throw DeviceError(device.info.name + " has no double precision: try --precision float or another --device");
    is_double() ? upload<f64::Layer, f64::LayerRow>(table) : upload<f32::Layer, f32::LayerRow>(table);
  }

  bool is_double() const { return precision == Precision::double_; }
  std::size_t lanes() const {
    return static_cast<std::size_t>(is_double() ? device.lanes.lanes_double : device.lanes.lanes_float);
  }

  template <class Layer, class Row>
  void upload(const LayerTable &table) {
    using Scalar = decltype(Layer::lift);
    std::vector<Layer> above_layers, below_layers;
    std::vector<Row> row_data;
    for (std::size_t w = 0; w < rows; ++w) {
      append_side(above_layers, table.above[w]);
      append_side(below_layers, table.below[w]);
      row_data.push_back({static_cast<Scalar>(table.eye_m), static_cast<Scalar>(table.index_eye[w]),
                          static_cast<Scalar>(table.above[w].lowest_lift),
                          static_cast<Scalar>(table.below[w].lowest_lift), table.level_rises[w] ? 1 : 0, 0});
    }
    above_layers.resize(above_layers.size() + 1);  // a buffer cannot be empty
    below_layers.resize(below_layers.size() + 1);
    try {
      above = cl::Buffer(device.context, above_layers.begin(), above_layers.end(), true);
      below = cl::Buffer(device.context, below_layers.begin(), below_layers.end(), true);
      row_buffer = cl::Buffer(device.context, row_data.begin(), row_data.end(), true);
    } catch (const cl::Error &error) {
      throw_failed_call(error, "uploading the layers", device.info.name);
    }
  }

  template <class Scalar, class End>
  std::vector<f64::RayEnd> run(std::span<const double> elevations_rad) {
    std::vector<f64::RayEnd> results;
    results.reserve(elevations_rad.size() * rows);
    const std::size_t batch = std::clamp<std::size_t>((std::size_t{1} << 21) / rows, 1024, most_elevations);
    const std::size_t chunk = std::min(batch, std::max<std::size_t>(elevations_rad.size(), 1));
    Buffer<Scalar> sines(device, chunk, "elevations"), cosines(device, chunk, "elevations");
    Buffer<End> ends(device, chunk * rows, "traced rays");
    std::vector<Scalar> sine(chunk), cosine(chunk);
    std::vector<End> host_ends(chunk * rows);
    for (std::size_t first = 0; first < elevations_rad.size(); first += chunk) {
      if (first > 0 && between_batches) between_batches();
      const std::size_t count = std::min(chunk, elevations_rad.size() - first);
      for (std::size_t i = 0; i < count; ++i) {
        sine[i] = static_cast<Scalar>(std::sin(elevations_rad[first + i]));
        cosine[i] = static_cast<Scalar>(std::cos(elevations_rad[first + i]));
      }
      sines.write(sine.data(), count);
      cosines.write(cosine.data(), count);
      if (!warm) {
        device.compile_seconds += launch(sines, cosines, ends, 1);
        warm = true;
      }
      stats.device_seconds += launch(sines, cosines, ends, count);
      ends.read(host_ends.data(), count * rows);
      for (std::size_t i = 0; i < count * rows; ++i) {
        results.push_back(widened(host_ends[i]));
        ++stats.rays;
        ++stats.outcomes[static_cast<std::size_t>(results.back().outcome)];
      }
    }
    return results;
  }

  template <class Scalar, class End>
  double launch(Buffer<Scalar> &sines, Buffer<Scalar> &cosines, Buffer<End> &ends, std::size_t count) {
    const int lane_count = static_cast<int>(lanes());
    const cl::Program program =
        build_program(device, {"closed_form", lane_count, is_double(), false, false, with_columns});
    try {
      cl::Kernel kernel(program, "trace_layers");
      kernel.setArg(0, above);
      kernel.setArg(1, below);
      kernel.setArg(2, row_buffer);
      kernel.setArg(3, sines.cl());
      kernel.setArg(4, cosines.cl());
      kernel.setArg(5, ends.cl());
      kernel.setArg(6, static_cast<cl_int>(count));
      kernel.setArg(7, layers_above);
      kernel.setArg(8, layers_below);
      const std::size_t local = static_cast<std::size_t>(device.lanes.local_size);
      const std::size_t items = (count + lanes() - 1) / lanes(), global = (items + local - 1) / local * local;
      const auto begin = std::chrono::steady_clock::now();
      device.queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(global, rows), cl::NDRange(local, 1));
      device.queue.finish();
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    } catch (const cl::Error &error) {
      throw_failed_call(error, "kernel trace_layers", device.info.name);
    }
  }

  std::shared_ptr<Device> owner;
  Device::State &device;
  Precision precision;
  std::size_t rows;
  int layers_above, layers_below;
  bool warm = false, with_columns = true;
  std::function<void()> between_batches;
  cl::Buffer above, below, row_buffer;
  TraceStats stats;
};

LayerTracer::LayerTracer(std::shared_ptr<Device> device, const LayerTable &table, Precision precision,
                         std::function<void()> between_batches, bool with_columns)
    : state_(std::make_unique<State>(std::move(device), table, precision)) {
  state_->between_batches = std::move(between_batches);
  state_->with_columns = with_columns;
}
LayerTracer::~LayerTracer() = default;
const TraceStats &LayerTracer::stats() const { return state_->stats; }

std::vector<f64::RayEnd> LayerTracer::trace(std::span<const double> elevations_rad) {
  return state_->is_double() ? state_->run<double, f64::RayEnd>(elevations_rad)
                             : state_->run<float, f32::RayEnd>(elevations_rad);
}

}  // namespace greenray
