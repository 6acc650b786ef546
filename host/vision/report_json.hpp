// The numbers of the eye as JSON: stable names (docs/eye.md).
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "vision/human_eye.hpp"

namespace greenray::vision {

nlohmann::json report_json(const EyeReport &report, const EyeOptions &options);

const char *name_of(PupilModel model);
const char *name_of(BleachModel model);

}  // namespace greenray::vision
