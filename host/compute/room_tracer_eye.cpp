// The eye's half of a RoomTracer: its paths, lamps seen, and what surfaces fill of a gather's disc.
#include <algorithm>

#include "compute/device_answers.hpp"
#include "compute/room_tracer_state.hpp"

namespace greenray {

EyeBand RoomTracer::see(const room_twin::EyeCamera &camera, std::span<const int> pixels) {
  const bool listed = !pixels.empty();
  const std::size_t count =
      (listed ? pixels.size() : static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.rows)) *
      static_cast<std::size_t>(camera.samples);
  EyeBand band;
  if (count == 0) return band;
  Buffer<room_twin::EyeSample> samples(state_->device, count, "paths of the eye");
  Buffer<float> radiance(state_->device, count * state_->waves, "light of eye paths");
  Buffer<float> weight(state_->device, count * state_->waves, "weights of eye paths");
  Buffer<int> list(state_->device, std::max<std::size_t>(pixels.size(), 1), "pixels with more paths");
  if (listed) list.write(pixels.data(), pixels.size());
  try {
    cl_uint next = 0;
    cl::Kernel &k = state_->kernel("trace_eye", next);
    k.setArg(next++, samples.cl());
    k.setArg(next++, radiance.cl());
    k.setArg(next++, weight.cl());
    k.setArg(next++, list.cl());
    k.setArg(next, camera);
    k.setArg(next + 1, static_cast<cl_int>(listed));
    if (!state_->warm.count("trace_eye")) {
      k.setArg(next + 2, cl_int{0});
      state_->warm_up("trace_eye", k);
    }
    k.setArg(next + 2, static_cast<cl_int>(count));
    state_->eye_seconds += state_->scene.state().launch(k, "trace_eye", count);
  } catch (const cl::Error &error) {
    throw_failed_call(error, "kernel trace_eye", state_->device.info.name);
  }
  band.samples.resize(count), band.radiance.resize(count * state_->waves), band.weight.resize(count * state_->waves);
  samples.read(band.samples.data(), count);
  radiance.read(band.radiance.data(), band.radiance.size());
  weight.read(band.weight.data(), band.weight.size());
  require_numbers(band.radiance, "radiances");
  require_numbers(band.weight, "weights of eye paths");
  return band;
}

std::vector<float> RoomTracer::see_lamps(const room_twin::EyeCamera &camera, const std::vector<int> &pixels) {
  std::vector<float> lamps(pixels.size() * state_->waves);
  if (pixels.empty()) return lamps;
  Buffer<int> list(state_->device, pixels.size(), "pixels at the edges of lamps");
  Buffer<float> seen(state_->device, lamps.size(), "light of lamps");
  list.write(pixels.data(), pixels.size());
  try {
    cl_uint next = 0;
    cl::Kernel &k = state_->kernel("see_lamps", next);
    k.setArg(next++, list.cl());
    k.setArg(next++, seen.cl());
    k.setArg(next, camera);
    if (!state_->warm.count("see_lamps")) {
      k.setArg(next + 1, cl_int{0});
      state_->warm_up("see_lamps", k);
    }
    k.setArg(next + 1, static_cast<cl_int>(pixels.size()));
    state_->eye_seconds += state_->scene.state().launch(k, "see_lamps", pixels.size());
  } catch (const cl::Error &error) {
    throw_failed_call(error, "kernel see_lamps", state_->device.info.name);
  }
  seen.read(lamps.data(), lamps.size());
  require_numbers(lamps, "radiances of lamps");
  return lamps;
}

std::vector<room_twin::Cover> RoomTracer::cover(std::span<const GatherPoint> points, std::span<const float> radius_m,
                                                double height, double facing) {
  std::vector<room_twin::Cover> covers(points.size());
  if (points.empty()) return covers;
  Buffer<GatherPoint> places(state_->device, points.size(), "places to gather at");
  Buffer<float> radii(state_->device, points.size(), "the radii of gathers");
  Buffer<room_twin::Cover> found(state_->device, points.size(), "the support of gathers");
  places.write(points.data(), points.size());
  radii.write(radius_m.data(), points.size());
  room_twin::CoverSettings settings{static_cast<float>(height), static_cast<float>(facing), 0, 0};
  try {
    cl_uint next = 0;
    cl::Kernel &k = state_->kernel("cover_gathers", next);
    k.setArg(next++, places.cl());
    k.setArg(next++, radii.cl());
    k.setArg(next++, found.cl());
    k.setArg(next, settings);
    state_->warm_up("cover_gathers", k);
    settings.count = static_cast<int>(points.size());
    k.setArg(next, settings);
    state_->scene.state().launch(k, "cover_gathers", points.size());
  } catch (const cl::Error &error) {
    throw_failed_call(error, "kernel cover_gathers", state_->device.info.name);
  }
  found.read(covers.data(), covers.size());
  return covers;
}

}  // namespace greenray
