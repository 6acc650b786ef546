// A room's picture between two passes, kept in a file, so that a run can be taken up again with the same bits.
#pragma once
#include <filesystem>
#include <optional>

#include "render/picture_part.hpp"
#include "render/room_maker.hpp"
#include "render/room_tally.hpp"

namespace greenray {

/// All that later passes and the picture depend on.
struct RoomState {
  int passes = 0;
  RoomBeginning beginning;
  BlockedTally tally{0, 1, 1};
  double seconds = 0;  // of all sessions
};

/// lanes: Device::lanes of each worker, "8" or "8,1": sums over lanes have an order of their own
PictureIdentity room_identity(const RoomScene &scene, const RoomOptions &options, const RoomPlan &plan,
                              const std::string &lanes);

struct RoomCheckpoint {
  PictureIdentity identity;
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
