// Questions to a photon map: how much light lands here, from the photons within a radius or from the nearest k.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "compute/photon_map.hpp"

namespace greenray {

struct GatherOptions {
  GatherKernel kernel = GATHER_EPANECHNIKOV;
  bool with_spread = false;  // what tells bias and noise, too
  int local_size = 0;        // 0: the device's own
  int points_per_item = 16;
};

/// Settings of GatherSettings in the words of a user. flatness: thickness of the support over its width, above 0 to 1;
/// 1: a ball. facing_deg: photons on surfaces that are turned by more are left out; 180: none is.
GatherSettings gather_settings(double radius_m, double flatness = 0.25, double facing_deg = 60);

/// One answer per point. Irradiance is in the unit of the photons' powers per m^2.
struct GatherAnswers {
  std::vector<float> irradiance;     // [points][waves]
  std::vector<GatherSpread> spread;  // [points]; 0 without GatherOptions::with_spread
  std::vector<Gathered> gathered;
};

class PhotonGather {
 public:
  PhotonGather(std::shared_ptr<Device> device, int waves, const GatherOptions &options);
  ~PhotonGather();

  /// The places that ask, kept on the device. Neighbours in space should be neighbours here: Morton or tile order.
  void set_points(std::span<const GatherPoint> points);
  /// From all photons nearer than settings.radius_m. Answers stay on the device until read().
  void within(const PhotonMap &map, const GatherSettings &settings);
  /// The same with a radius of its own for each point; settings.radius_m does not matter.
  void within(const PhotonMap &map, GatherSettings settings, std::span<const float> radius_m);
  /// From the settings.nearest nearest photons within settings.radius_m, the farthest of them only setting the radius.
  void nearest(const PhotonMap &map, const GatherSettings &settings);
  GatherAnswers read() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace greenray
