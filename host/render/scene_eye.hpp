// The [eye] part of a scene as options of the human eye.
#pragma once
#include "scene/scene.hpp"
#include "vision/human_eye.hpp"

namespace greenray {

/// fov_deg: of the picture as rendered, crops included.
vision::EyeOptions eye_options_of(const EyeScene &eye, double fov_deg);

}  // namespace greenray
