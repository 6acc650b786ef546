// A room's picture in shares, made apart and put together again: --shard I/N and `greenray merge`.
#pragma once
#include "render/picture_part.hpp"
#include "render/room.hpp"

namespace greenray {

/* Makes a share of the picture's passes into options.checkpoint, which is its part and, until that is complete, the
   checkpoint of this run: blocks of passes (BlockedTally) index, index + count ... The first pass is traced by every
   share, for its radii and edges. head.command is kept in it. At most one block is in memory but for those that are
   new since the part was last written.
   errors: InputError (an error or a time to reach; a part of another picture, with Resume::always), as render_room */
RoomReport render_room_share(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device,
                             const PictureShare &share, const PartHead &head);

struct MergedRoom {
  RoomPicture picture;
  std::string device_json;  // of the first share
};

/// Parts of every share, in any order, for the picture of this scene with these options. Needs no device.
/// errors: InputError (parts that are damaged, of other pictures, missing, doubled, not finished)
MergedRoom merge_room(const RoomScene &scene, const RoomOptions &options,
                      const std::vector<std::filesystem::path> &parts);

}  // namespace greenray
