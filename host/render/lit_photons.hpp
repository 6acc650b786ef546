// Irradiance found beforehand at some of the photons, so that a place only looks for the nearest of them.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "compute/photon_gather.hpp"

namespace greenray {

struct PassIrradiance;

/* source: Christensen, "Faster photon map global illumination", Journal of Graphics Tools 4 (1999): the nearest photon
   that faces the same way. It pays where many more places are asked than there are such photons; the picture is then
   made of patches as large as they are apart. */
class LitPhotons {
 public:
  LitPhotons(std::shared_ptr<Device> device, int waves) : device_(std::move(device)), waves_(waves) {}

  /// Files `light`, answers at these places. apart_m: how far the places are from one another, about.
  void file(std::span<const GatherPoint> places, const PassIrradiance &light, const Bounds &bounds, double apart_m);
  /// Adds what the nearest holds to sum, for each place. Nothing within most_radius_m: 0.
  void ask(std::span<const GatherPoint> places, double most_radius_m, PassIrradiance &sum);

 private:
  std::shared_ptr<Device> device_;
  int waves_;
  double apart_m_ = 1;
  std::unique_ptr<PhotonMap> map_;
  std::unique_ptr<PhotonGather> gather_;
};

}  // namespace greenray
