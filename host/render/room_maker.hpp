// Passes of a room on a device, any of them by itself once the first one was made here or elsewhere.
#pragma once
#include <memory>
#include <optional>

#include "render/room.hpp"
#include "render/room_eye.hpp"
#include "render/room_photons.hpp"
#include "scene/bvh.hpp"

namespace greenray {

/// What later passes take from the first one.
struct RoomBeginning {
  std::int64_t photons_a_pass = 0;
  std::array<int, 2> slots{};    // RoomPhotons::slots()
  std::vector<float> radii;      // PhotonMapper::radii()
  std::vector<int> lamp_pixels;  // RoomEye::lamp_pixels() of as many passes as are told beside it
  std::vector<int> edge_pixels;  // RoomEye::edge_pixels()

  template <class Sink>
  void write(Sink &to) const {
    to.add(std::vector<std::int64_t>{photons_a_pass, slots[0], slots[1]});
    to.add(radii), to.add(lamp_pixels), to.add(edge_pixels);
  }
  /// counts: of radii, lamp pixels, edge pixels
  template <class Source>
  void read(Source &from, const std::array<std::size_t, 3> &counts) {
    std::vector<std::int64_t> numbers;
    from.take(numbers, 3);
    photons_a_pass = numbers[0];
    slots = {static_cast<int>(numbers[1]), static_cast<int>(numbers[2])};
    from.take(radii, counts[0]), from.take(lamp_pixels, counts[1]), from.take(edge_pixels, counts[2]);
  }
  std::array<std::size_t, 3> counts() const { return {radii.size(), lamp_pixels.size(), edge_pixels.size()}; }
};

struct MadePass {
  RoomPass pass;
  PhotonTotals photons;
  std::vector<int> lamp_pixels;  // known after it
};

class RoomMaker {
 public:
  RoomMaker(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device,
            const RoomPlan &plan);
  const RoomPlan &plan() const { return plan_; }
  const RoomLooks &looks() const { return looks_; }
  RoomEye &eye() { return *eye_; }

  /// Before the first pass: makes passes small enough for the device.
  void begin();
  /// Before later ones. lamp_passes: whose lamps are in it. errors: RunError when it is of another picture
  void begin(const RoomBeginning &from, int lamp_passes);
  RoomBeginning beginning();
  /// between(phase, part of the pass): told before its two parts; may throw to stop it.
  MadePass make(int pass, const std::function<void(const char *, double)> &between);

  /// What is known without any pass, and the seconds spent.
  void describe(RoomReport &report) const;
  /// The photon map by itself, of the first pass made here; empty unless asked for.
  std::optional<SpectralImage> take_photon_map() { return std::move(photon_map_); }

 private:
  void make_eye();
  void picture_photons(const RoomPass &seen);

  const RoomScene scene_;  // as it is traced
  RoomOptions options_;
  std::shared_ptr<Device> device_;
  RoomPlan plan_;
  RoomLooks looks_;
  AirTable air_;
  SurfaceTree tree_;
  bool alone_ = false;
  RoomReport known_;
  double compiled_before_ = 0;
  std::optional<RoomTracer> tracer_;
  std::optional<RoomPhotons> photons_;
  std::optional<RoomEye> eye_;
  std::optional<SpectralImage> photon_map_;
};

/// The plan whose passes are as large as these. errors: InputError at `place`
void fit_passes(RoomPlan &plan, std::int64_t photons_a_pass, const RoomScene &scene, const RoomOptions &options,
                const SourcePlace &place);

/// Of each pixel of the region: is it in the crop, without those around it?
std::vector<unsigned char> counting_pixels(const RoomPlan &plan);
/// The crop of values over the region, `each` a pixel, times scale.
std::vector<float> cropped(const RoomPlan &plan, const std::vector<float> &values, std::size_t each, float scale);

}  // namespace greenray
