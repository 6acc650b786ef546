// Peer: nanoflann's k-d tree in float on host threads, given every fair chance: several leaf sizes; results unsorted;
// the radius search with a result set of its own, which makes the estimate at once instead of a list (`sum`), or a list
// that keeps its memory (`list`).
#include <nanoflann.hpp>

#include "bench/photon_peer.hpp"
#include "bench/race.hpp"

namespace greenray::bench {
namespace {

struct Cloud {
  std::span<const Photon> photons;
  std::size_t kdtree_get_point_count() const { return photons.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return photons[i].place_m[axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box &) const {
    return false;
  }
};

using Index = std::uint32_t;
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, Index>;

/// A result set that adds up the estimate.
class Estimate {
 public:
  Estimate(float radius2, std::span<const float> power_W) : radius2_(radius2), power_W_(power_W.data()) {}
  bool addPoint(float distance2, Index index) {
    if (distance2 < radius2_) {
      sum_ += (1 - distance2 / radius2_) * power_W_[index];
      ++count_;
    }
    return true;
  }
  bool full() const { return true; }
  float worstDist() const { return radius2_; }
  std::size_t size() const { return static_cast<std::size_t>(count_); }
  float irradiance() const { return sum_ * 2 / (3.14159265f * radius2_); }

 private:
  float radius2_;
  const float *power_W_;
  float sum_ = 0;
  int count_ = 0;
};

class NanoflannTree : public NeighbourTree {
 public:
  NanoflannTree(std::span<const Photon> photons, std::span<const float> power_W, unsigned threads, std::size_t leaf,
                bool list)
      : cloud_{photons}, power_W_(power_W), threads_(threads), list_(list), tree_(3, cloud_, {leaf}) {
    tree_.buildIndex();
  }

  void within(std::span<const GatherPoint> points, float radius_m, std::span<float> irradiance,
              std::span<int> counts) const override {
    const float radius2 = radius_m * radius_m;
    const nanoflann::SearchParams unsorted(0, 0, false);
    on_threads(points.size(), 1024, threads_, [&](std::size_t first, std::size_t last) {
      std::vector<std::pair<Index, float>> found;
      for (std::size_t i = first; i < last; ++i) {
        Estimate estimate(radius2, power_W_);
        if (list_) {
          tree_.radiusSearch(points[i].place_m, radius2, found, unsorted);
          for (const auto &[index, distance2] : found) estimate.addPoint(distance2, index);
        } else {
          tree_.findNeighbors(estimate, points[i].place_m, unsorted);
        }
        irradiance[i] = estimate.irradiance();
        counts[i] = static_cast<int>(estimate.size());
      }
    });
  }

  void nearest(std::span<const GatherPoint> points, int k, std::span<float> radius2) const override {
    on_threads(points.size(), 256, threads_, [&](std::size_t first, std::size_t last) {
      std::vector<Index> indices(static_cast<std::size_t>(k));
      std::vector<float> distances2(static_cast<std::size_t>(k));
      for (std::size_t i = first; i < last; ++i) {
        nanoflann::KNNResultSet<float, Index> found(static_cast<std::size_t>(k));
        found.init(indices.data(), distances2.data());
        tree_.findNeighbors(found, points[i].place_m, nanoflann::SearchParams());
        radius2[i] = found.worstDist();
      }
    });
  }

 private:
  Cloud cloud_;
  std::span<const float> power_W_;
  unsigned threads_;
  bool list_;
  Tree tree_;
};

}  // namespace

std::vector<NeighbourPeer> nanoflann_peers(bool few) {
  std::string version = std::to_string(NANOFLANN_VERSION >> 8) + "." + std::to_string(NANOFLANN_VERSION >> 4 & 15) +
                        "." + std::to_string(NANOFLANN_VERSION & 15);
  std::vector<NeighbourPeer> peers;
  for (const std::size_t leaf : {10u, 16u, 32u})
    for (const bool list : {false, true}) {
      if (few && (leaf != 16 || list)) continue;
      if (list && leaf != 16) continue;
      peers.push_back({"nanoflann", version, "nanoflann leaf " + std::to_string(leaf) + (list ? " list" : ""),
                       [leaf, list](std::span<const Photon> photons, std::span<const float> power_W,
                                    unsigned threads) -> std::unique_ptr<NeighbourTree> {
                         return std::make_unique<NanoflannTree>(photons, power_W, threads, leaf, list);
                       }});
    }
  return peers;
}

}  // namespace greenray::bench
