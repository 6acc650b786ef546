// What a picture of a room would cost, from a small one that is really made.
#pragma once
#include <memory>
#include <optional>

#include "render/room.hpp"

namespace greenray {

struct RoomEstimate {
  std::optional<double> seconds;  // of the whole picture; nothing while an error decides when it is done
  double seconds_a_pass = 0;
  double compile_seconds = 0, probe_seconds = 0;
  std::size_t device_bytes = 0;
};

/* A sixteenth of the pixels and a thirty-second of the photons, scaled up by what each part grows with. Within a factor
   of three where the picture takes more than a second. errors: those of render_room */
RoomEstimate estimate_room(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device);

}  // namespace greenray
