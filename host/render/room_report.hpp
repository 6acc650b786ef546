// The report of a scene with surfaces, with the contract's names.
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "render/room.hpp"

namespace greenray {

struct CameraReport;

/// What is modelled and what is left out, with reasons.
nlohmann::json room_plan_json(const RoomScene &scene, const RoomOptions &options);

/// device: as device_json (render/report.hpp)
nlohmann::json room_report_json(const RoomScene &scene, const RoomOptions &options, const RoomReport &report,
                                const nlohmann::json &device, double develop_seconds, double total_seconds);

}  // namespace greenray
