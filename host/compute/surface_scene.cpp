#include "compute/surface_scene.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "compute/surface_scene_state.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

/// A buffer cannot be empty.
std::size_t room_for(std::size_t count) { return std::max<std::size_t>(count, 1); }

template <class T>
void fill(Buffer<T> &buffer, const std::vector<T> &values) {
  if (!values.empty()) buffer.write(values.data(), values.size());
}

double largest_extent_m(const surface32::GeometryBounds &b) {
  return std::max({static_cast<double>(b.high[0] - b.low[0]), static_cast<double>(b.high[1] - b.low[1]),
                   static_cast<double>(b.high[2] - b.low[2])});
}

}  // namespace

SurfaceScene::State::State(std::shared_ptr<Device> d, const SurfaceTree &tree, const AirTable &air,
                           double longest_sag_m)
    : owner(std::move(d)),
      device(owner->state()),
      lanes(tree.lanes),
      curved(!air.is_straight()),
      bounds(tree.bounds),
      shape{static_cast<int>(air.layers.size()), static_cast<int>(air.cells), static_cast<float>(air.extinction_per_m),
            static_cast<float>(longest_sag_m > 0 ? longest_sag_m : 0.05 * largest_extent_m(tree.bounds))},
      boxes(device, room_for(tree.boxes.size()), "the tree's boxes"),
      blocks(device, room_for(tree.blocks.size()), "the tree's triangles"),
      children(device, room_for(tree.children.size()), "the tree's nodes"),
      block_ids(device, room_for(tree.block_ids.size()), "the tree's triangle numbers"),
      triangles(device, room_for(tree.triangles.size()), "the triangles"),
      spheres(device, room_for(tree.spheres.size()), "the spheres"),
      layers(device, air.layers.size(), "the medium"),
      cells(device, air.rows.size(), "the medium") {
  if (lanes != lanes_for(*owner)) throw std::invalid_argument("SurfaceScene: the tree was laid out for other lanes");
  fill(boxes, tree.boxes);
  fill(blocks, tree.blocks);
  fill(children, tree.children);
  fill(block_ids, tree.block_ids);
  fill(triangles, tree.triangles);
  fill(spheres, tree.spheres);
  fill(layers, air.narrowed_layers());
  fill(cells, air.narrowed());
}

cl_uint SurfaceScene::State::bind_surfaces(cl::Kernel &kernel, cl_uint first) const {
  kernel.setArg(first++, boxes.cl());
  kernel.setArg(first++, children.cl());
  kernel.setArg(first++, blocks.cl());
  kernel.setArg(first++, block_ids.cl());
  kernel.setArg(first++, triangles.cl());
  kernel.setArg(first++, spheres.cl());
  kernel.setArg(first++, bounds);
  return first;
}

cl_uint SurfaceScene::State::bind(cl::Kernel &kernel, cl_uint first) const {
  first = bind_surfaces(kernel, first);
  kernel.setArg(first++, layers.cl());
  kernel.setArg(first++, cells.cl());
  kernel.setArg(first++, shape);
  return first;
}

cl::Program SurfaceScene::State::program(const std::string &entry, const std::string &words) const {
  BuildPlan plan{entry, lanes, false, false, false, false};
  plan.words = std::string(" -DAIR_IS_CURVED=") + (curved ? "1" : "0") + words;
  return build_program(device, plan);
}

double SurfaceScene::State::launch(cl::Kernel &kernel, const char *name, std::size_t count) const {
  if (count == 0) return 0;
  try {
    const std::size_t local = static_cast<std::size_t>(device.lanes.local_size);
    const auto begin = std::chrono::steady_clock::now();
    device.queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange((count + local - 1) / local * local),
                                      cl::NDRange(local));
    device.queue.finish();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  } catch (const cl::Error &error) {
    throw_failed_call(error, std::string("kernel ") + name, device.info.name);
  }
}

SurfaceScene::SurfaceScene(std::shared_ptr<Device> device, const SurfaceTree &tree, const AirTable &air,
                           double longest_sag_m)
    : state_(std::make_unique<State>(std::move(device), tree, air, longest_sag_m)) {}
SurfaceScene::~SurfaceScene() = default;

int SurfaceScene::lanes_for(const Device &device) { return device.lanes().lanes_float; }
bool SurfaceScene::is_curved() const { return state_->curved; }
double SurfaceScene::kernel_seconds() const { return state_->kernel_seconds; }

std::vector<surface32::PathEnd> SurfaceScene::trace(std::span<const surface32::PathStart> starts) {
  std::vector<surface32::PathEnd> results(starts.size());
  if (starts.empty()) return results;
  Buffer<surface32::PathStart> in(state_->device, starts.size(), "paths");
  Buffer<surface32::PathEnd> out(state_->device, starts.size(), "ends of paths");
  in.write(starts.data(), starts.size());
  try {
    cl::Kernel kernel(state_->program("probe_geometry"), "trace_paths");
    const cl_uint next = state_->bind(kernel, 0);
    kernel.setArg(next, in.cl());
    kernel.setArg(next + 1, out.cl());
    kernel.setArg(next + 2, static_cast<cl_int>(starts.size()));
    state_->kernel_seconds = state_->launch(kernel, "trace_paths", starts.size());
  } catch (const cl::Error &error) {
    throw_failed_call(error, "kernel trace_paths", state_->device.info.name);
  }
  out.read(results.data(), results.size());
  return results;
}

void SurfaceScene::load(std::span<const surface32::Segment> segments) {
  state_->segments.reset(), state_->segment_hits.reset();
  if (segments.empty()) return;
  state_->segments.emplace(state_->device, segments.size(), "segments");
  state_->segment_hits.emplace(state_->device, segments.size(), "hits");
  state_->segments->write(segments.data(), segments.size());
}

void SurfaceScene::run_loaded() {
  if (!state_->segments) return;
  try {
    cl::Kernel kernel(state_->program("probe_geometry"), "find_on_segments");
    const cl_uint next = state_->bind_surfaces(kernel, 0);
    kernel.setArg(next, state_->segments->cl());
    kernel.setArg(next + 1, state_->segment_hits->cl());
    kernel.setArg(next + 2, static_cast<cl_int>(state_->segments->count()));
    state_->kernel_seconds = state_->launch(kernel, "find_on_segments", state_->segments->count());
  } catch (const cl::Error &error) {
    throw_failed_call(error, "kernel find_on_segments", state_->device.info.name);
  }
}

std::vector<surface32::SegmentHit> SurfaceScene::find_loaded() {
  std::vector<surface32::SegmentHit> results(state_->segments ? state_->segments->count() : 0);
  run_loaded();
  if (!results.empty()) state_->segment_hits->read(results.data(), results.size());
  return results;
}

std::vector<surface32::SegmentHit> SurfaceScene::find(std::span<const surface32::Segment> segments) {
  load(segments);
  return find_loaded();
}

}  // namespace greenray
