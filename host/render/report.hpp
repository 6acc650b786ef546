// The numbers of a render as JSON: stable names (docs/file-formats.md).
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "image/develop.hpp"
#include "render/renderer.hpp"

namespace greenray {

struct OutputSeconds {
  double eye = 0, total = 0;
};

nlohmann::json choices_json(const std::vector<PlanChoice> &choices);
nlohmann::json plan_json(const RenderPlan &plan);
nlohmann::json report_json(const Scene &scene, const RenderPlan &plan, const RenderOptions &options,
                           const RenderReport &report, const Device &device, const CameraReport &camera,
                           const OutputSeconds &seconds);
nlohmann::json camera_json(const CameraReport &camera);
nlohmann::json device_json(const Device &device);

}  // namespace greenray
