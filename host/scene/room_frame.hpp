// What has to be known of a room before it becomes floats: how far its origin is, and which glass things stand in.
#pragma once
#include "scene/room_scene.hpp"

namespace greenray {

/* The scene moved to its own middle where that lies far from the origin (more than its size), so that floats tell its
   places apart: along x and y, and along z where neither a medium nor a Sun through the air depends on the height.
   errors: InputError where surfaces, camera or lights are still farther from the origin than 20000 times the size of
   the scene, beyond 1e7 m, where the scene is smaller than a micrometre, or for more than 32766 materials */
RoomScene moved_to_middle(RoomScene scene);

/// The glass that a place is in, and one around it, as paths hold it (Path::glass in kernels/surface/path.h); 0: none.
/// By the surfaces of glass that are left, but were not entered, along a direction; of three directions at least two
/// agree.
int glass_around(const RoomScene &scene, const Triple &place);

/// The same of a light: point and spot by their place, area lights by the front of their first surface.
int glass_around_light(const RoomScene &scene, int light);

}  // namespace greenray
