// A room's picture between two passes, kept in a file, so that a run can be taken up again with the same bits.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "render/room_plan.hpp"

namespace greenray {

/// All that later passes and the picture depend on. Which passes are behind is part of `statistics`.
struct RoomState {
  int passes = 0;
  std::int64_t photons_a_pass = 0;
  PhotonTotals photons;
  std::vector<double> statistics;  // PixelStatistics::state()
  std::vector<float> radii;        // PhotonMapper::radii()
  std::vector<float> sums;         // of depth, bend and photon count: [3][pixels]
  std::vector<int> lamp_pixels, edge_pixels;
  double seconds = 0;  // of all sessions
};

/// What makes this picture's passes: the scene's keys, the options and the program.
struct RoomIdentity {
  std::string scene_hash;
  std::map<std::string, std::string> values;  // of the scene
  std::map<std::string, std::string> options;
};
RoomIdentity room_identity(const RoomScene &scene, const RoomOptions &options, const RoomPlan &plan);

/// "photons.gather was 150, is 100": what of `then` is not so now and changes the picture; empty: the checkpoint fits.
std::vector<std::string> changed_keys(const RoomIdentity &then, const RoomIdentity &now);

struct RoomCheckpoint {
  RoomIdentity identity;
  RoomState state;
};

/// Whole or not at all; the old one stays until then.
void write_checkpoint(const std::filesystem::path &path, const RoomCheckpoint &checkpoint);
/// Nothing if there is no such file.
/// errors: InputError if it is damaged or no checkpoint
std::optional<RoomCheckpoint> read_checkpoint(const std::filesystem::path &path);
/// Removes the checkpoint, and what killed runs may have left of this one.
void remove_checkpoint(const std::filesystem::path &path);
/// Temporaries of `target` (support/atomic_file.hpp) whose process is gone.
void remove_stale_temporaries(const std::filesystem::path &target);

}  // namespace greenray
