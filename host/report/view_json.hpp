// The diagnosis of a view as JSON: stable names (docs/file-formats.md).
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "render/view_diagnosis.hpp"

namespace greenray {

nlohmann::json view_json(const ViewDiagnosis &view);
/// Layers of the air and what to expect of them: also what `greenray profile` prints.
nlohmann::json air_json(const Diagnosis &air);

}  // namespace greenray
