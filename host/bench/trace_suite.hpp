// Suite trace: rays per second against the error of total refraction, for our integrators and for peers.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "bench/peer.hpp"
#include "bench/record.hpp"
#include "compute/device.hpp"

namespace greenray::bench {

struct SuiteOptions {
  int repeats = 7;
  bool quick = false;                            // few rays, few settings: to see that it works, not how fast
  unsigned threads = 1;                          // of peers: as many as the device has
  std::string only;                              // methods whose variant contains this; "": all
  std::vector<unsigned> scale{};                 // thread counts to compare, by device fission; {}: one and all
  DeviceOptions device;                          // opened again with one lane
  std::function<void(const std::string &)> say;  // progress
  std::function<void(const Record &)> done;      // each record as it is made
};

/// peers: methods beside ours; may be empty. Four airs, each with its own double reference, then run_scaling
/// (bench/README.md).
std::vector<Record> run_trace_suite(const SuiteOptions &options, const std::vector<Method> &peers);

/// Suite images: seconds of whole pictures against their RMS error, by look-up in the transfer table and pixel by
/// pixel.
std::vector<Record> run_images_suite(const SuiteOptions &options);

/// Suite scenes: seconds by phase of shipped scenes.
std::vector<Record> run_scenes_suite(const SuiteOptions &options);

/// Part of suite scenes: RMS error of rooms against seconds, by number of photons, and the error that they claim.
std::vector<Record> run_rooms(const SuiteOptions &options, const std::shared_ptr<Device> &device);

/// Slope of ln(error) against ln(photons) by least squares; 0 of fewer than two records with both.
double convergence_slope(const std::vector<Record> &records);

/// Suite eye: the human eye on pictures of fixed size; tone mappers of pfstools where they are installed.
std::vector<Record> run_eye_suite(const SuiteOptions &options);

/// The peer's point that a record is held against: of the points that no other point of the same peer beats in both
/// speed and error, the one with the smallest error that is not below ours. The peer is then at most as accurate as we
/// are, and at our own accuracy it would be slower: the ratio is never flattered. None if every point of the peer is
/// more accurate.
std::optional<PeerPoint> fair_peer(const Record &ours, const std::vector<Record> &peer_points);

}  // namespace greenray::bench
