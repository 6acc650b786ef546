// What the eye sees of a room in one pass: paths, lamps, and the light gathered where paths end. Bands of pixels, so
// that memory is bounded whatever the picture is.
#pragma once
#include <optional>
#include <vector>

#include "render/photon_mapper.hpp"
#include "render/pixel_statistics.hpp"
#include "render/room_plan.hpp"

namespace greenray {

/// Where a path asks the photons; no_place() where it does not.
GatherPoint point_of(const room_twin::EyeSample &sample);

/// Values of the picture's region in one pass, averages over the pass's samples.
struct RoomPass {
  std::vector<float> radiance;                          // [pixels][waves]
  std::vector<float> narrower, variance;                // [pixels], as in PassPixels
  std::vector<float> depth_m, bend_mrad, photon_count;  // [pixels]
  std::vector<GatherPoint> ends;                        // [pixels][samples] of paths
};

class RoomEye {
 public:
  /// glass: glass_around the camera.
  RoomEye(const CameraScene &camera, int glass, const RoomPlan &plan, std::uint32_t seed, bool alone,
          std::size_t waves);

  /// Bytes on the device for one band.
  std::size_t device_bytes() const;
  /// When the first pass is filed: the radii of all places. They hang together over the whole picture, so that it is
  /// looked at as a whole, whatever the crop.
  void find_radii(RoomTracer &tracer, PhotonMapper &mapper);
  /// The pass that the mapper has filed. It also finds the edges of lamps: pixels around which (RoomPlan::margin) more
  /// and less light of lamps is seen; they get lamp_samples more paths in every pass, for their lamps alone. Pixels
  /// that are four times as bright or dark as one beside them in pass 0 get edge_samples more in every pass, with radii
  /// of their own.
  RoomPass see(int pass, RoomTracer &tracer, PhotonMapper &mapper);

  const std::vector<int> &lamp_pixels() const { return lamp_pixels_; }  // of the region
  void set_lamp_pixels(std::vector<int> pixels) { lamp_pixels_ = std::move(pixels); }
  const std::vector<int> &edge_pixels() const { return edge_pixels_; }  // of the region
  void set_edge_pixels(std::vector<int> pixels) { edge_pixels_ = std::move(pixels); }
  double gather_seconds() const { return gather_seconds_; }

  static constexpr int lamp_samples = 64, edge_samples = 8;

 private:
  using Box = std::array<int, 4>;  // x0, y0, x1, y1, the last two excluded
  std::vector<Box> bands_of(const Box &box) const;
  EyeBand see_band(const Box &band, int pass, RoomTracer &tracer) const;
  std::vector<GatherPoint> survey(RoomTracer &tracer) const;
  room_twin::EyeCamera camera_for(const Box &box, int pass) const;
  void add_band(const Box &box, const EyeBand &band, PhotonMapper &mapper, RoomPass &out);
  void add_sample(const EyeBand &band, const PassIrradiance &light, std::size_t sample, std::size_t pixel, float share,
                  RoomPass &out);
  std::vector<int> lamp_edges() const;
  void add_lamp_pixels(const std::vector<int> &found);
  std::vector<int> light_edges(const RoomPass &pass) const;
  std::vector<std::size_t> around(std::span<const int> pixels) const;
  void resample_edges(int pass, RoomTracer &tracer, PhotonMapper &mapper, RoomPass &out);
  void mix(std::span<const int> pixels, const EyeBand &band, const PassIrradiance &light, RoomPass &out);
  void resample_lamps(int pass, RoomTracer &tracer, RoomPass &out);

  CameraScene from_;
  int glass_;
  RoomPlan plan_;
  std::uint32_t seed_;
  bool alone_;
  std::size_t waves_;
  std::optional<EyeBand> first_band_;  // of pass 0, where one band is the whole picture
  std::vector<float> lamps_;           // [pixels][waves], light of lamps in the current pass
  std::vector<int> lamp_pixels_, edge_pixels_;
  static constexpr std::size_t most_samples = std::size_t{1} << 18;  // on the device at once
  double gather_seconds_ = 0;
};

}  // namespace greenray
