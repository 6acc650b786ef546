// What the planner decides for a room, each with its reason and its cost.
#pragma once
#include "render/renderer.hpp"
#include "render/room.hpp"

namespace greenray {

/// Do wavelengths part on the way through the medium by more than a two-hundredth of reach_m? The bend's difference,
/// averaged over the heights, times the square of the way.
bool medium_disperses(const AirTable &air, double reach_m);

/// Tabulates the medium, so that costs are measured; needs no device.
std::vector<PlanChoice> room_choices(const RoomScene &scene, const RoomOptions &options);

}  // namespace greenray
