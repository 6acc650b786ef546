// Photons and eye paths of a scene with surfaces, on a device.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "compute/photon_map.hpp"
#include "compute/surface_scene.hpp"
#include "twin/room_twin.hpp"

namespace greenray {

/// Materials, textures and lights by wavelength, as the device holds them.
struct RoomLooks {
  std::vector<double> wavelength_nm;
  std::vector<room_twin::Material> materials;
  std::vector<float> spectra;  // [rows][wavelengths]
  std::vector<room_twin::Texture> textures;
  std::vector<room_twin::SpectrumCurve> texels;
  std::vector<room_twin::Light> lights;
  std::vector<room_twin::LightPrimitive> light_primitives;
  std::vector<double> light_power_W_nm;  // of each light, summed over the wavelengths

  std::size_t waves() const { return wavelength_nm.size(); }
  const float *row(int number) const { return spectra.data() + static_cast<std::size_t>(number) * waves(); }
};

/// Where the power of photons went [W/nm, summed over the wavelengths], and how many there were of what.
struct PhotonTotals {
  double emitted = 0, absorbed = 0, escaped = 0, medium = 0, dropped = 0;
  std::uint64_t photons = 0, pieces = 0;   // launched; path pieces traced
  std::array<std::uint64_t, 2> stored{};   // diffuse, caustic
  std::array<std::uint64_t, 4> outcome{};  // absorbed, escaped, dropped, not finite
  double seconds = 0;                      // of the kernel
  void add(const PhotonTotals &other);
};

/// Photons of one pass, and the room there is to store them.
struct PhotonBatch {
  std::uint32_t seed = 1, pass = 0, first = 0, photons = 0;
  int chunk = 256;                 // followed by one work-item
  std::array<int, 2> slots{0, 0};  // of each chunk in the diffuse and the caustic map; 0: only counted
  int most_bounces = 64;
  bool alone = false;         // one wavelength a photon
  bool keep_caustics = true;  // false: they are traced by themselves, aimed; these photons are not stored as such
  std::size_t chunks() const {
    return (photons + static_cast<std::uint32_t>(chunk) - 1) / static_cast<std::uint32_t>(chunk);
  }
};

/// Where each light's photons go to meet glass and mirrors: kernels/shared/projection.h.
struct AimedLights {
  std::vector<room_twin::LightProjection> lights;
  std::vector<int> cells;      // lists of marked ones
  std::vector<float> weights;  // [lights][PROJECTION_CELLS]
};

/// What eye paths brought: [samples], and [samples][waves].
struct EyeBand {
  std::vector<room_twin::EyeSample> samples;
  std::vector<float> radiance, weight;
};

class RoomTracer {
 public:
  RoomTracer(std::shared_ptr<Device> device, const SurfaceTree &tree, const AirTable &air, const RoomLooks &looks);
  ~RoomTracer();

  /// Shares of the lights changed (share_photons).
  void set_lights(const std::vector<room_twin::Light> &lights);

  /// Counts what a batch would store, and stores nothing. most: of any chunk
  PhotonTotals count(const PhotonBatch &batch, std::array<int, 2> &most);
  /// Traces a batch into the maps' records (chunks() * slots of each), holes included. returns false, with nothing to
  /// rely on in the maps, when a chunk needed more slots than it had; `most` then says how many
  bool store(const PhotonBatch &batch, PhotonMap &diffuse, PhotonMap &caustic, PhotonTotals &totals,
             std::array<int, 2> &most);
  /// Tries each cell of each light with `samples` photons. returns: [lights][PROJECTION_CELLS], how many of them meet a
  /// surface that is not Lambert first
  std::vector<int> mark_cells(const PhotonBatch &batch, const std::vector<room_twin::LightProjection> &projections,
                              int samples);
  void set_aim(const AimedLights &aim);
  /// Traces a batch of aimed photons into the map's records, one slot for each. Their powers are not in the totals.
  void store_caustics(const PhotonBatch &batch, PhotonMap &caustic, PhotonTotals &totals);
  /// camera.width * rows * samples paths; with a list of pixels, numbers within that band, samples paths of each.
  EyeBand see(const room_twin::EyeCamera &camera, std::span<const int> pixels = {});
  /// The light of lamps alone, [pixels][waves], mean of camera.samples paths through each of these pixels of the band.
  std::vector<float> see_lamps(const room_twin::EyeCamera &camera, const std::vector<int> &pixels);
  double eye_seconds() const;
  /// Paths to their next surface, as in SurfaceScene.
  std::vector<surface32::PathEnd> trace(std::span<const surface32::PathStart> starts);
  /// Which part of the disc of each gather is surface that photons could land on (kernels/surface/cover.h).
  /// height: over the radius; facing: cosine, as in GatherSettings
  std::vector<room_twin::Cover> cover(std::span<const GatherPoint> points, std::span<const float> radius_m,
                                      double height, double facing);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace greenray
