// The part of `greenray trace` that tells about a view as a whole: of a scene, or of an eye in a profile.
#pragma once
#include <string>

#include "cli/commands.hpp"
#include "render/view_diagnosis.hpp"

namespace greenray::cli {

/// `greenray trace SCENE`, or PROFILE --height M, without a list of altitudes.
int trace_view(const Arguments &arguments);

/// "1200", "1.2km", "4000ft", "0.75mi", "0.65nmi" -> metres; a plain number is in metres.
/// errors: InputError where that is no such length, or outside [low_m, high_m]
double length_m(const Arguments &arguments, const std::string &flag, double low_m, double high_m);

/// --target-distance and --target-height, both or none.
std::optional<Target> target_from(const Arguments &arguments);

}  // namespace greenray::cli
