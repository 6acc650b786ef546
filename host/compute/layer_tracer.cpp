#include "compute/layer_tracer.hpp"

#include <algorithm>
#include <cmath>

#include "compute/layer_tracer_state.hpp"
#include "compute/ray_end.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

constexpr std::size_t most_elevations = std::size_t{1} << 16;  // of one launch

template <class Layer>
void append_layers(std::vector<Layer> &out, const std::vector<LayerData> &layers, std::size_t count) {
  using Scalar = decltype(Layer::lift);
  const auto narrow = [](double x) { return static_cast<Scalar>(x); };
  for (std::size_t i = 0; i < count; ++i) {
    const LayerData &data = layers[i];
    Layer layer;
    layer.lift = narrow(data.lift), layer.bulge = narrow(data.bulge), layer.skew = narrow(data.skew);
    layer.far_m = narrow(data.far_m);
    std::transform(data.mean.begin(), data.mean.end(), layer.mean, narrow);
    std::transform(data.tilt.begin(), data.tilt.end(), layer.tilt, narrow);
    std::transform(data.bow.begin(), data.bow.end(), layer.bow, narrow);
    out.push_back(layer);
  }
}

template <class Node>
void append_nodes(std::vector<Node> &out, const std::vector<FarNode> &nodes) {
  using Scalar = decltype(Node::lift);
  for (const FarNode &data : nodes) {
    Node node;
    node.lift = static_cast<Scalar>(data.lift);
    std::transform(data.weight.begin(), data.weight.end(), node.weight,
                   [](double x) { return static_cast<Scalar>(x); });
    out.push_back(node);
  }
}

/// Lowest lift of the layers that are summed one by one: rays steeper than that never turn.
double lowest_lift(const std::vector<LayerData> &layers, std::size_t count) {
  double lowest = 0;
  for (std::size_t i = 0; i < count; ++i) lowest = std::min(lowest, layers[i].lift);
  return lowest;
}

template <class T>
cl::Buffer filled_buffer(const Device::State &device, std::vector<T> values) {
  values.resize(values.size() + 1);  // a buffer cannot be empty
  return cl::Buffer(device.context, values.begin(), values.end(), true);
}

}  // namespace

LayerTracer::State::State(std::shared_ptr<Device> d, const LayerTable &table, Precision p)
    : owner(std::move(d)),
      device(owner->state()),
      precision(p),
      rows(table.wavelength_nm.size()),
      near_above(static_cast<cl_int>(table.near_above)),
      layers_below(static_cast<cl_int>(table.below.front().layers.size())),
      far_nodes(static_cast<cl_int>(table.far.front().size())),
      local_size(static_cast<std::size_t>(device.lanes.local_size)) {
  if (is_double() && !device.info.has_double)
    throw DeviceError(device.info.name + " has no double precision: try --precision float or another --device");
  is_double() ? upload<f64::Layer, f64::FarNode, f64::LayerRow>(table)
              : upload<f32::Layer, f32::FarNode, f32::LayerRow>(table);
}

template <class Layer, class Node, class Row>
void LayerTracer::State::upload(const LayerTable &table) {
  using Scalar = decltype(Layer::lift);
  std::vector<Layer> above_layers, below_layers;
  std::vector<Node> nodes;
  std::vector<Row> row_data;
  for (std::size_t w = 0; w < rows; ++w) {
    const std::vector<LayerData> &up = table.above[w].layers, &down = table.below[w].layers;
    append_layers(above_layers, up, table.near_above);
    append_layers(below_layers, down, down.size());
    append_nodes(nodes, table.far[w]);
    Row row{};
    row.eye_m = static_cast<Scalar>(table.eye_m);
    row.index_eye = static_cast<Scalar>(table.index_eye[w]);
    row.lowest_lift_above = static_cast<Scalar>(lowest_lift(up, table.near_above));
    row.lowest_lift_below = static_cast<Scalar>(lowest_lift(down, down.size()));
    row.top_m = static_cast<Scalar>(up.empty() ? table.eye_m : up.back().far_m);
    row.level_rises = table.level_rises[w] ? 1 : 0;
    row_data.push_back(row);
  }
  try {
    above = filled_buffer(device, std::move(above_layers));
    below = filled_buffer(device, std::move(below_layers));
    far = filled_buffer(device, std::move(nodes));
    row_buffer = filled_buffer(device, std::move(row_data));
  } catch (const cl::Error &error) {
    throw_failed_call(error, "uploading the layers", device.info.name);
  }
}

cl::Kernel LayerTracer::State::kernel(const char *name, bool with_columns, int groups) {
  const cl::Program program =
      build_program(device, {"closed_form", static_cast<int>(lanes()), is_double(), false, false, with_columns});
  try {
    cl::Kernel kernel(program, name);
    kernel.setArg(0, above);
    kernel.setArg(1, below);
    kernel.setArg(2, far);
    kernel.setArg(3, row_buffer);
    kernel.setArg(4, cl_int4{{near_above, layers_below, far_nodes, groups}});
    return kernel;
  } catch (const cl::Error &error) {
    throw_failed_call(error, std::string("kernel ") + name, device.info.name);
  }
}

double LayerTracer::State::launch(cl::Kernel &kernel, std::size_t items, std::size_t rays) {
  try {
    const std::size_t global = (items + local_size - 1) / local_size * local_size;
    const auto begin = std::chrono::steady_clock::now();
    device.queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(global, rows, rays),
                                      cl::NDRange(local_size, 1, 1));
    device.queue.finish();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  } catch (const cl::Error &error) {
    throw_failed_call(error, "a kernel of closed_form.cl", device.info.name);
  }
}

namespace {

template <class Scalar, class End, class State>
std::vector<f64::RayEnd> trace_all(State &state, std::span<const double> elevations_rad) {
  const std::size_t rows = state.rows, lanes = state.lanes();
  std::vector<f64::RayEnd> results;
  results.reserve(elevations_rad.size() * rows);
  const std::size_t batch = std::clamp<std::size_t>((std::size_t{1} << 21) / rows, 1024, most_elevations);
  const std::size_t chunk = std::min(batch, std::max<std::size_t>(elevations_rad.size(), 1));
  Buffer<Scalar> sines(state.device, chunk, "elevations"), cosines(state.device, chunk, "elevations");
  Buffer<End> ends(state.device, chunk * rows, "traced rays");
  std::vector<Scalar> sine(chunk), cosine(chunk);
  std::vector<End> host_ends(chunk * rows);
  cl::Kernel kernel = state.kernel("trace_layers", true, 1);
  kernel.setArg(5, sines.cl());
  kernel.setArg(6, cosines.cl());
  kernel.setArg(7, ends.cl());
  for (std::size_t first = 0; first < elevations_rad.size(); first += chunk) {
    if (first > 0 && state.between_batches) state.between_batches();
    const std::size_t count = std::min(chunk, elevations_rad.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      sine[i] = static_cast<Scalar>(std::sin(elevations_rad[first + i]));
      cosine[i] = static_cast<Scalar>(std::cos(elevations_rad[first + i]));
    }
    sines.write(sine.data(), count);
    cosines.write(cosine.data(), count);
    kernel.setArg(8, static_cast<cl_int>(count));
    if (!state.warm) state.device.compile_seconds += state.launch(kernel, 1);
    state.warm = true;
    state.stats.device_seconds += state.launch(kernel, (count + lanes - 1) / lanes);
    ends.read(host_ends.data(), count * rows);
    for (std::size_t i = 0; i < count * rows; ++i) {
      results.push_back(widened(host_ends[i]));
      ++state.stats.rays;
      ++state.stats.outcomes[static_cast<std::size_t>(results.back().outcome)];
    }
  }
  return results;
}

template <class Scalar>
std::vector<Scalar> narrowed(std::span<const double> values, double (*f)(double)) {
  std::vector<Scalar> out;
  for (double v : values) out.push_back(static_cast<Scalar>(f(v)));
  return out;
}

double same(double x) { return x; }

template <class Scalar, class End, class State>
std::vector<f64::RayEnd> all_places(State &state, std::span<const double> elevations_rad,
                                    std::span<const double> distances_m) {
  std::vector<f64::RayEnd> results;
  if (elevations_rad.empty() || distances_m.empty()) return results;
  const std::size_t each = state.rows * distances_m.size();
  results.reserve(elevations_rad.size() * each);
  const std::size_t chunk = std::clamp<std::size_t>((std::size_t{1} << 20) / each, 1, elevations_rad.size());
  Buffer<Scalar> sines(state.device, chunk, "elevations"), cosines(state.device, chunk, "elevations");
  Buffer<Scalar> distances(state.device, distances_m.size(), "distances");
  Buffer<End> ends(state.device, chunk * each, "places on rays");
  std::vector<End> host_ends(chunk * each);
  distances.write(narrowed<Scalar>(distances_m, same).data(), distances_m.size());
  const bool abreast = distances_m.size() < state.lanes();  // few distances: rays side by side instead
  cl::Kernel kernel = state.kernel(abreast ? "place_rays_abreast" : "place_rays", true, 1);
  kernel.setArg(5, sines.cl());
  kernel.setArg(6, cosines.cl());
  kernel.setArg(7, distances.cl());
  kernel.setArg(8, ends.cl());
  kernel.setArg(9, static_cast<cl_int>(distances_m.size()));
  const auto groups = [&](std::size_t items) { return (items + state.lanes() - 1) / state.lanes(); };
  for (std::size_t first = 0; first < elevations_rad.size(); first += chunk) {
    if (first > 0 && state.between_batches) state.between_batches();
    const auto some = elevations_rad.subspan(first, std::min(chunk, elevations_rad.size() - first));
    sines.write(narrowed<Scalar>(some, std::sin).data(), some.size());
    cosines.write(narrowed<Scalar>(some, std::cos).data(), some.size());
    if (abreast) kernel.setArg(10, static_cast<cl_int>(some.size()));
    state.stats.device_seconds += abreast ? state.launch(kernel, groups(some.size()), distances_m.size())
                                          : state.launch(kernel, groups(distances_m.size()), some.size());
    ends.read(host_ends.data(), some.size() * each);
    for (std::size_t i = 0; i < some.size() * each; ++i) results.push_back(widened(host_ends[i]));
  }
  return results;
}

}  // namespace

LayerTracer::LayerTracer(std::shared_ptr<Device> device, const LayerTable &table, Precision precision,
                         std::function<void()> between_batches, int local_size)
    : state_(std::make_unique<State>(std::move(device), table, precision)) {
  state_->between_batches = std::move(between_batches);
  if (local_size > 0) state_->local_size = static_cast<std::size_t>(local_size);
}
LayerTracer::~LayerTracer() = default;
const TraceStats &LayerTracer::stats() const { return state_->stats; }

std::vector<f64::RayEnd> LayerTracer::trace(std::span<const double> elevations_rad) {
  return state_->is_double() ? trace_all<double, f64::RayEnd>(*state_, elevations_rad)
                             : trace_all<float, f32::RayEnd>(*state_, elevations_rad);
}

std::vector<f64::RayEnd> LayerTracer::places(std::span<const double> elevations_rad,
                                             std::span<const double> distances_m) {
  return state_->is_double() ? all_places<double, f64::RayEnd>(*state_, elevations_rad, distances_m)
                             : all_places<float, f32::RayEnd>(*state_, elevations_rad, distances_m);
}

}  // namespace greenray
