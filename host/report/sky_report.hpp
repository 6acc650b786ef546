// The report of a picture of the sky: OUT.html, and its numbers for OUT.json.
#pragma once
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "image/png.hpp"
#include "render/renderer.hpp"
#include "report/rim_colour.hpp"

namespace greenray {

struct SkyReportInput {
  const Scene &scene;
  const RenderPlan &plan;
  const RenderOptions &options;
  const Rendered &rendered;
  const Raster &developed;  // the finished picture
  double key_cd_m2 = 0;     // of a camera; 0: an eye, then the straight picture is keyed on itself
  std::string command;      // that repeats it
};

/* Adds the objects view, refraction, rim, trust and command to `numbers` (the picture's report_json, which the page
   shows too), and returns the page. Traces the view's diagnosis and, unless the picture itself is straight, a small
   picture of the same scene without bending, its Sun where it is without air. errors: as render's */
std::string sky_report(const SkyReportInput &input, nlohmann::json &numbers, const std::shared_ptr<Device> &device);

}  // namespace greenray
