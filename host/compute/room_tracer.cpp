#include "compute/room_tracer.hpp"

#include <algorithm>

#include "compute/room_tracer_state.hpp"
#include "support/error.hpp"

namespace greenray {

void PhotonTotals::add(const PhotonTotals &o) {
  emitted += o.emitted, absorbed += o.absorbed, escaped += o.escaped, medium += o.medium, dropped += o.dropped;
  photons += o.photons, pieces += o.pieces, seconds += o.seconds;
  for (std::size_t i = 0; i < stored.size(); ++i) stored[i] += o.stored[i];
  for (std::size_t i = 0; i < outcome.size(); ++i) outcome[i] += o.outcome[i];
}

RoomTracer::RoomTracer(std::shared_ptr<Device> device, const SurfaceTree &tree, const AirTable &air,
                       const RoomLooks &looks)
    : state_(std::make_unique<State>(std::move(device), tree, air, looks)) {}
RoomTracer::~RoomTracer() = default;
double RoomTracer::eye_seconds() const { return state_->eye_seconds; }
std::vector<surface32::PathEnd> RoomTracer::trace(std::span<const surface32::PathStart> starts) {
  return state_->scene.trace(starts);
}

void RoomTracer::set_lights(const std::vector<room_twin::Light> &lights) {
  if (!lights.empty()) state_->lights.buffer.write(lights.data(), lights.size());
}

PhotonTotals RoomTracer::count(const PhotonBatch &batch, std::array<int, 2> &most) {
  PhotonBatch counted = batch;
  counted.slots = {0, 0};
  Buffer<Photon> none(state_->device, 1, "photons");
  Buffer<float> no_power(state_->device, state_->waves, "photons");
  return state_->trace(counted, {none.cl(), no_power.cl()}, {none.cl(), no_power.cl()}, most);
}

bool RoomTracer::store(const PhotonBatch &batch, PhotonMap &diffuse, PhotonMap &caustic, PhotonTotals &totals,
                       std::array<int, 2> &most) {
  PhotonMap::State &d = diffuse.state(), &c = caustic.state();
  for (std::size_t i = 0; i < 2; ++i) {
    const PhotonMap::State &map = i == 0 ? d : c;
    if (map.records.count() < batch.chunks() * static_cast<std::size_t>(batch.slots[i]))
      throw RunError("a photon map is too small for its photons");
  }
  most = {0, 0};
  PhotonTotals now =
      state_->trace(batch, {d.records.cl(), d.record_power_W.cl()}, {c.records.cl(), c.record_power_W.cl()}, most);
  if (!batch.keep_caustics) most[1] = 0, now.stored[1] = 0;
  if (most[0] > batch.slots[0] || most[1] > batch.slots[1]) return false;
  totals.add(now);
  return true;
}

std::vector<int> RoomTracer::mark_cells(const PhotonBatch &batch,
                                        const std::vector<room_twin::LightProjection> &projections, int samples) {
  State &s = *state_;
  const std::size_t cells = projections.size() * room_twin::PROJECTION_CELLS;
  State::Filled<room_twin::LightProjection> lights(s.device, projections, "projection maps");
  Buffer<int> counts(s.device, std::max<std::size_t>(cells, 1), "projection maps");
  std::vector<int> found(cells);
  if (found.empty()) return found;
  try {
    cl_uint next = 0;
    cl::Kernel &k = s.kernel("mark_cells", next);
    k.setArg(next++, lights.buffer.cl());
    k.setArg(next++, counts.cl());
    k.setArg(next + 1, static_cast<cl_int>(samples));
    room_twin::PhotonSettings settings = s.settings_of(batch);
    settings.lights = 0;
    k.setArg(next, settings);
    s.warm_up("mark_cells", k);
    settings.lights = s.light_count;
    k.setArg(next, settings);
    s.scene.state().launch(k, "mark_cells", cells);
  } catch (const cl::Error &error) {
    throw_failed_call(error, "kernel mark_cells", s.device.info.name);
  }
  counts.read(found.data(), cells);
  return found;
}

void RoomTracer::set_aim(const AimedLights &aim) {
  state_->projections.emplace(state_->device, aim.lights, "projection maps");
  state_->projected_cells.emplace(state_->device, aim.cells, "projection maps");
  state_->projected_weights.emplace(state_->device, aim.weights, "projection maps");
}

void RoomTracer::store_caustics(const PhotonBatch &batch, PhotonMap &caustic, PhotonTotals &totals) {
  State &s = *state_;
  PhotonMap::State &map = caustic.state();
  if (!s.projections) throw RunError("caustic photons without projection maps");
  if (map.records.count() < batch.chunks() * static_cast<std::size_t>(batch.slots[0]))
    throw RunError("a photon map is too small for its photons");
  Buffer<room_twin::ChunkTally> tallies(s.device, std::max<std::size_t>(batch.chunks(), 1), "tallies of photons");
  PhotonTotals now;
  try {
    cl_uint next = 0;
    cl::Kernel &k = s.kernel("trace_caustics", next);
    for (const cl::Buffer &buffer :
         {s.projections->buffer.cl(), s.projected_cells->buffer.cl(), s.projected_weights->buffer.cl(),
          map.records.cl(), map.record_power_W.cl(), tallies.cl()})
      k.setArg(next++, buffer);
    room_twin::PhotonSettings settings = s.settings_of(batch);
    settings.photons = 0;
    k.setArg(next, settings);
    s.warm_up("trace_caustics", k);
    settings.photons = batch.photons;
    k.setArg(next, settings);
    now.seconds = s.scene.state().launch(k, "trace_caustics", batch.chunks());
  } catch (const cl::Error &error) {
    throw_failed_call(error, "kernel trace_caustics", s.device.info.name);
  }
  std::vector<room_twin::ChunkTally> read(batch.chunks());
  tallies.read(read.data(), read.size());
  std::array<int, 2> most{};
  for (const room_twin::ChunkTally &t : read) State::note(t, now, most);
  now.photons = batch.photons;
  totals.add(now);
}

}  // namespace greenray
