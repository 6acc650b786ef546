// What of a scene stands before the sky, for a table of hidden heights.
#pragma once
#include <vector>

#include "render/view_diagnosis.hpp"
#include "scene/scene.hpp"

namespace greenray {

/// The scene's targets with what their tops reach above the surface, in its order, and the highest place of its terrain
/// within the picture's width, if it is land.
std::vector<SceneTarget> targets_in_view(const Scene &scene);

}  // namespace greenray
