// What has to be known of a room before it becomes floats: how far its origin is, and which glass things stand in.
#pragma once
#include "scene/room_scene.hpp"

namespace greenray {

/* The scene moved to its own middle where that lies far from the origin (more than its size), so that floats tell its
   places apart: along x and y, and along z where neither a medium nor a Sun through the air depends on the height.
   errors: InputError where surfaces, camera or lights are still farther from the origin than 20000 times the size of
   the scene, beyond 1e7 m, or where the scene is smaller than a micrometre */
RoomScene moved_to_middle(RoomScene scene);

/// 1 + number of the dielectric material that the place is inside of; 0: none. As paths leave glass: by the first
/// surface of glass that is met from behind, told along three directions.
int glass_around(const RoomScene &scene, const Triple &place);

/// The same of a light: point and spot by their place, area lights by the front of their first surface.
int glass_around_light(const RoomScene &scene, int light);

}  // namespace greenray
