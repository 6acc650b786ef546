// The flags of the eye that several commands share.
#pragma once
#include "cli/arguments.hpp"
#include "vision/human_eye.hpp"

namespace greenray::cli {

/// Pupil, age, eyes.
std::vector<Flag> pupil_flags();
/// All that makes an observer human: display, glare, acuity, colour, bleaching.
std::vector<Flag> eye_flags();

bool on_or_off(const Arguments &a, const std::string &flag, bool otherwise);
vision::PupilModel pupil_model(const Arguments &a);
vision::Display display_from(const Arguments &a);
vision::EyeOptions eye_options(const Arguments &a);

}  // namespace greenray::cli
