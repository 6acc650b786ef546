#include "compute/room_tracer.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "compute/photon_map_state.hpp"
#include "compute/surface_scene_state.hpp"
#include "support/error.hpp"

namespace greenray {

void PhotonTotals::add(const PhotonTotals &o) {
  emitted += o.emitted, absorbed += o.absorbed, escaped += o.escaped, medium += o.medium, dropped += o.dropped;
  photons += o.photons, pieces += o.pieces, seconds += o.seconds;
  for (std::size_t i = 0; i < stored.size(); ++i) stored[i] += o.stored[i];
  for (std::size_t i = 0; i < outcome.size(); ++i) outcome[i] += o.outcome[i];
}

struct RoomTracer::State {
  State(std::shared_ptr<Device> d, const SurfaceTree &tree, const AirTable &air, const RoomLooks &looks)
      : scene(std::move(d), tree, air),
        device(scene.state().device),
        waves(looks.waves()),
        light_count(static_cast<int>(looks.lights.size())),
        materials(device, looks.materials, "materials"),
        spectra(device, looks.spectra, "spectra"),
        textures(device, looks.textures, "textures"),
        texels(device, looks.texels, "textures"),
        lights(device, looks.lights, "lights"),
        light_primitives(device, looks.light_primitives, "lights") {}

  /// A buffer with its contents; never empty.
  template <class T>
  struct Filled {
    Filled(Device::State &device, const std::vector<T> &values, const char *what)
        : buffer(device, std::max<std::size_t>(values.size(), 1), what) {
      if (!values.empty()) buffer.write(values.data(), values.size());
    }
    Buffer<T> buffer;
  };

  /// The kernel with scene and looks bound; PoCL compiles it at its first launch, which is of nothing.
  cl::Kernel &kernel(const char *entry, cl_uint &next) {
    const std::string words = " -DWAVES=" + std::to_string(waves);
    const bool is_made = kernels.count(entry);
    if (!is_made) kernels[entry] = cl::Kernel(scene.state().program(entry, words), entry);
    cl::Kernel &k = kernels[entry];
    next = scene.state().bind(k, 0);
    k.setArg(next++, materials.buffer.cl());
    k.setArg(next++, spectra.buffer.cl());
    k.setArg(next++, textures.buffer.cl());
    k.setArg(next++, texels.buffer.cl());
    k.setArg(next++, lights.buffer.cl());
    k.setArg(next++, light_primitives.buffer.cl());
    return k;
  }

  room_twin::PhotonSettings settings_of(const PhotonBatch &batch) const {
    return {batch.seed,  batch.pass,     batch.first,        batch.photons,       light_count,
            batch.chunk, batch.slots[0], batch.most_bounces, batch.alone ? 1 : 0, 0};
  }

  void warm_up(const char *entry, cl::Kernel &k) {
    if (!warm.insert(entry).second) return;
    device.compile_seconds += scene.state().launch(k, entry, 1);
  }

  struct Target {
    const cl::Buffer &records, &power;
  };

  PhotonTotals trace(const PhotonBatch &batch, const Target &diffuse, const Target &caustic, std::array<int, 2> &most) {
    const std::size_t chunks = batch.chunks();
    Buffer<room_twin::ChunkTally> tallies(device, std::max<std::size_t>(chunks, 1), "tallies of photons");
    const room_twin::PhotonSettings settings = settings_of(batch);
    PhotonTotals totals;
    try {
      cl_uint next = 0;
      cl::Kernel &k = kernel("trace_photons", next);
      k.setArg(next++, diffuse.records);
      k.setArg(next++, diffuse.power);
      k.setArg(next++, caustic.records);
      k.setArg(next++, caustic.power);
      k.setArg(next++, tallies.cl());
      if (!warm.count("trace_photons")) {
        room_twin::PhotonSettings nothing = settings;
        nothing.photons = 0;
        k.setArg(next, nothing);
        k.setArg(next + 1, cl_int{0});
        warm_up("trace_photons", k);
      }
      k.setArg(next, settings);
      k.setArg(next + 1, static_cast<cl_int>(batch.slots[1]));
      totals.seconds = scene.state().launch(k, "trace_photons", chunks);
    } catch (const cl::Error &error) {
      throw_failed_call(error, "kernel trace_photons", device.info.name);
    }
    std::vector<room_twin::ChunkTally> read(chunks);
    tallies.read(read.data(), chunks);
    totals.photons = batch.photons;
    for (const room_twin::ChunkTally &t : read) note(t, totals, most);
    return totals;
  }

  static void note(const room_twin::ChunkTally &t, PhotonTotals &totals, std::array<int, 2> &most) {
    const auto power = [&](int k) { return static_cast<double>(t.power[k]); };
    totals.emitted += power(room_twin::TALLY_EMITTED);
    totals.absorbed += power(room_twin::TALLY_ABSORBED);
    totals.escaped += power(room_twin::TALLY_ESCAPED);
    totals.medium += power(room_twin::TALLY_MEDIUM);
    totals.dropped += power(room_twin::TALLY_DROPPED);
    totals.pieces += static_cast<std::uint64_t>(t.bounces);
    for (std::size_t i = 0; i < 4; ++i) totals.outcome[i] += static_cast<std::uint64_t>(t.outcome[i]);
    for (std::size_t i = 0; i < 2; ++i) {
      totals.stored[i] += static_cast<std::uint64_t>(t.stored[i]);
      most[i] = std::max(most[i], t.stored[i]);
    }
  }

  SurfaceScene scene;
  Device::State &device;
  std::size_t waves;
  int light_count;
  Filled<room_twin::Material> materials;
  Filled<float> spectra;
  Filled<room_twin::Texture> textures;
  Filled<room_twin::SpectrumCurve> texels;
  Filled<room_twin::Light> lights;
  Filled<room_twin::LightPrimitive> light_primitives;
  std::optional<Filled<room_twin::LightProjection>> projections;
  std::optional<Filled<int>> projected_cells;
  std::optional<Filled<float>> projected_weights;
  std::map<std::string, cl::Kernel> kernels;
  std::set<std::string> warm;
  double eye_seconds = 0;
};

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

EyeBand RoomTracer::see(const room_twin::EyeCamera &camera) {
  const std::size_t count = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.rows) *
                            static_cast<std::size_t>(camera.samples);
  EyeBand band;
  if (count == 0) return band;
  Buffer<room_twin::EyeSample> samples(state_->device, count, "paths of the eye");
  Buffer<float> radiance(state_->device, count * state_->waves, "light of eye paths");
  Buffer<float> weight(state_->device, count * state_->waves, "weights of eye paths");
  try {
    cl_uint next = 0;
    cl::Kernel &k = state_->kernel("trace_eye", next);
    k.setArg(next++, samples.cl());
    k.setArg(next++, radiance.cl());
    k.setArg(next++, weight.cl());
    if (!state_->warm.count("trace_eye")) {
      room_twin::EyeCamera nothing = camera;
      nothing.width = 0;
      k.setArg(next, nothing);
      state_->warm_up("trace_eye", k);
    }
    k.setArg(next, camera);
    state_->eye_seconds += state_->scene.state().launch(k, "trace_eye", count);
  } catch (const cl::Error &error) {
    throw_failed_call(error, "kernel trace_eye", state_->device.info.name);
  }
  band.samples.resize(count), band.radiance.resize(count * state_->waves), band.weight.resize(count * state_->waves);
  samples.read(band.samples.data(), count);
  radiance.read(band.radiance.data(), band.radiance.size());
  weight.read(band.weight.data(), band.weight.size());
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
