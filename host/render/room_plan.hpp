// How a picture of a room is cut into passes, photons, samples and bands of pixels.
#pragma once
#include <array>
#include <cstdint>

#include "render/room.hpp"

namespace greenray {

/// Photons of one pass at most, so that maps stay small however many there are in all.
constexpr std::int64_t most_photons_a_pass = std::int64_t{1} << 21;

struct RoomPlan {
  std::array<int, 2> size{};  // of the whole picture
  std::array<int, 4> crop{};  // x0, y0, x1, y1: what is wanted
  /// The crop and `margin` pixels around it, beyond the picture too: every crop finds the same edges of lamps.
  std::array<int, 4> region{};
  static constexpr int margin = 2;
  std::int64_t photons = 0;  // in all passes; while open: of the passes of an ordinary picture
  std::int64_t photons_a_pass = 0;
  int passes = 1;     // at most
  bool open = false;  // until the error or the time is reached, passes of the same size
  int samples = 1;    // of a pixel in each pass
  int nearest = 1;    // photons of one estimate in pass 0
  /// Passes that are more by themselves for a larger number of photons keep their radius; others' shrink from one to
  /// the next.
  bool even_radii = false;

  /// The whole picture with its margin.
  std::array<int, 4> frame() const { return {-margin, -margin, size[0] + margin, size[1] + margin}; }
  int width() const { return region[2] - region[0]; }
  int height() const { return region[3] - region[1]; }
  std::size_t pixels() const { return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()); }
  std::uint32_t photons_of(int pass) const;
};

/* Four passes, one where there are fewer than 40000 photons; more where a pass would have more than
   most_photons_a_pass, and of more photons than the scene's own, as (photons/emitted)^(2/3). With an error or a time to
   reach: passes as large as those, without end unless spp or photons are given. errors: InputError for a crop outside
   the picture */
RoomPlan plan_room(const RoomScene &scene, const RoomOptions &options);

/// The same picture in passes of half as many photons.
void halve_passes(RoomPlan &plan, const RoomScene &scene, const RoomOptions &options);

}  // namespace greenray
