// What a neighbour search looks like to the benchmark: a tree over the photons that answers all points.
#pragma once
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compute/photon.hpp"

namespace greenray::bench {

/// Answers by a peer on host threads. One wavelength.
class NeighbourTree {
 public:
  virtual ~NeighbourTree() = default;
  /// Irradiance by Epanechnikov's kernel and the number of photons nearer than radius_m.
  virtual void within(std::span<const GatherPoint> points, float radius_m, std::span<float> irradiance,
                      std::span<int> counts) const = 0;
  /// Squared distance of the k-th nearest photon.
  virtual void nearest(std::span<const GatherPoint> points, int k, std::span<float> radius2) const = 0;
};

struct NeighbourPeer {
  std::string peer, version, variant;
  std::function<std::unique_ptr<NeighbourTree>(std::span<const Photon>, std::span<const float> power_W,
                                               unsigned threads)>
      build;
};

/// nanoflann's static tree (bench/nanoflann_peer.cpp); linked only where it was found.
std::vector<NeighbourPeer> nanoflann_peers(bool few);

}  // namespace greenray::bench
