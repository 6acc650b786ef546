// The OpenCL side of a RoomTracer. Included by host/compute only.
#pragma once
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "compute/device_answers.hpp"
#include "compute/photon_map_state.hpp"
#include "compute/room_tracer.hpp"
#include "compute/surface_scene_state.hpp"

namespace greenray {

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
    require_balance(totals);
    return totals;
  }

  static void note(const room_twin::ChunkTally &t, PhotonTotals &totals, std::array<int, 2> &most) {
    const bool counts = t.bounces >= 0 && std::min({t.stored[0], t.stored[1]}) >= 0 &&
                        std::min({t.outcome[0], t.outcome[1], t.outcome[2], t.outcome[3]}) >= 0;
    if (!counts) throw_bad_answer("counts of photons");
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

  /// Every photon ends somewhere; floats of a chunk add up to 1e-5 of it.
  static void require_balance(const PhotonTotals &t) {
    const double ends = t.absorbed + t.escaped + t.medium + t.dropped;
    if (!(std::abs(t.emitted - ends) <= 1e-3 * std::abs(t.emitted))) throw_bad_answer("powers of photons");
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

}  // namespace greenray
