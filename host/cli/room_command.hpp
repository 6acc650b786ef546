// greenray render and check for scenes with a [camera].
#pragma once
#include <optional>

#include <string>

#include "cli/render_command.hpp"
#include "render/renderer.hpp"

namespace greenray::cli {

/// One line each: what was chosen, why, what it costs.
void print_choices(const std::vector<PlanChoice> &choices);

/// Renders the scene if it has surfaces; nothing if it is a sky scene, or is not there. returns: exit code
std::optional<int> render_room_scene(const Arguments &a, Session &session);

/// Of such a scene; nothing if it is a sky scene, or is not there.
std::optional<std::string> room_scene_hash(const Arguments &a);

/// Says what a render of it would do. Nothing if it is a sky scene, or is not there.
std::optional<int> check_room_scene(const Arguments &a, Session &session);

}  // namespace greenray::cli
