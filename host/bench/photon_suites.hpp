// Suites photons (filing them) and gather (asking the map), beside neighbour trees and std::sort.
#pragma once
#include <vector>

#include "bench/photon_peer.hpp"
#include "bench/trace_suite.hpp"

namespace greenray::bench {

/// Photons filed per second.
std::vector<Record> run_photons_suite(const SuiteOptions &options, const std::vector<NeighbourPeer> &peers);

/// Points answered per second: within a radius that holds 150 photons on average, and by exactly 150 photons.
std::vector<Record> run_gather_suite(const SuiteOptions &options, const std::vector<NeighbourPeer> &peers);

/// Something timed that makes one record; several in turn.
struct Contender {
  Record record;  // suite, case, variant, device, error and `more` filled in
  double count;   // units of work in one run
  bool is_peer;
  std::function<void()> run;
};

/// Races warm contenders. Each of ours is held against the fastest peer that is no more accurate; all do the same work.
std::vector<Record> race_group(std::vector<Contender> &group, const SuiteOptions &options, const std::string &peer,
                               const std::string &version);

}  // namespace greenray::bench
