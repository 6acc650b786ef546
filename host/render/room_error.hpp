// How far directions of paths through a room's medium can be trusted.
#pragma once
#include "atmosphere/air_table.hpp"
#include "compute/room_tracer.hpp"
#include "scene/room_scene.hpp"

namespace greenray {

/* Error of the device's solver [arcsec]: 64 paths from the camera in all directions to the first surface. Along each
   the horizontal momentum is constant and |p| = n (Bouguer, and the eikonal equation), so that what |p|^2 at the end
   differs from n^2 there, in double, over 2 n |p|, is an error of direction. Straight media: 0, there is nothing to
   solve. */
double room_solver_error_arcsec(RoomTracer &tracer, const AirTable &air, const CameraScene &camera);

/// The table's error of places at the end of a path across the scene, as an angle seen from its start [arcsec].
double room_table_error_arcsec(const AirTable &air, double reach_m);

}  // namespace greenray
