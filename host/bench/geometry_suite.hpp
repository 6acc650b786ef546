// Suite geometry: segments and paths among triangles, beside Embree.
#pragma once
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/trace_suite.hpp"
#include "scene/bvh.hpp"

namespace greenray::bench {

/// A searcher for the nearest triangle on a segment, on host threads.
class SegmentPeer {
 public:
  virtual ~SegmentPeer() = default;
  virtual void find(std::span<const surface32::Segment> segments, std::span<surface32::SegmentHit> hits) = 0;
  virtual std::string version() const = 0;
};
using MakeSegmentPeer = std::function<std::unique_ptr<SegmentPeer>(const Surfaces &, unsigned threads)>;

/// Embree's rtcIntersect1 (bench/embree_peer.cpp); linked only where it was found.
std::unique_ptr<SegmentPeer> embree_peer(const Surfaces &surfaces, unsigned threads);

/* Photons of the cross room, from the light into the filed map, per second: straight and curved, a sixteenth of them,
   and among the same surfaces in 12 800 and 204 800 triangles. error: share of the emitted power that is neither
   absorbed nor escaped at the end. */
std::vector<Record> race_room_photons(const SuiteOptions &options, const std::shared_ptr<Device> &device);

/* Cases: short segments (a tenth of the scene) among 100 000 triangles, and 16 times as many; whole paths in a straight
   and in a curved medium; photons of the cross room. error: share of segments that do not meet what a brute-force
   search in double meets. */
std::vector<Record> run_geometry_suite(const SuiteOptions &options, const MakeSegmentPeer &peer);

}  // namespace greenray::bench
