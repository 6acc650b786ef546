// The report of a picture of a room: OUT.html, from its JSON.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "image/png.hpp"

namespace greenray {

/// numbers: room_report_json with `command`. photon_map: the map as a picture, where one was made.
std::string room_page(const nlohmann::json &numbers, const Raster &developed, const std::optional<Raster> &photon_map);

}  // namespace greenray
