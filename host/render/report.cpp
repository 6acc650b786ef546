#include "render/report.hpp"

#include <nlohmann/json.hpp>

#include "scene/scene_file.hpp"
#include "support/version.hpp"

namespace greenray {
namespace {

using Json = nlohmann::json;

Json optional(const std::optional<double> &value) { return value ? Json(*value) : Json(); }

Json outcomes_json(const OutcomeCounts &counts) {
  Json out;
  for (int i = 1; i < static_cast<int>(counts.size()); ++i) out[outcome_name(i)] = counts[static_cast<std::size_t>(i)];
  return out;
}

}  // namespace

nlohmann::json device_json(const Device &device) {
  const DeviceInfo &d = device.info();
  return {{"address", d.address()},
          {"name", d.name},
          {"platform", d.platform_name},
          {"driver", d.driver},
          {"version", d.version},
          {"compute_units", d.compute_units},
          {"lanes_float", device.lanes().lanes_float},
          {"lanes_double", device.lanes().lanes_double},
          {"budget_bytes", device.budget_bytes()}};
}

nlohmann::json camera_json(const CameraReport &camera) {
  return {{"key_cd_m2", camera.key_cd_m2},
          {"exposure_ev", camera.exposure_ev},
          {"gamut_moved", camera.gamut_moved},
          {"replaced", camera.replaced}};
}

nlohmann::json choices_json(const std::vector<PlanChoice> &choices) {
  Json all = Json::array();
  for (const PlanChoice &c : choices)
    all.push_back({{"what", c.what},
                   {"chosen", c.chosen},
                   {"why", c.why},
                   {"cost", c.cost_unit.empty() ? Json() : Json(c.cost)},
                   {"cost_unit", c.cost_unit.empty() ? Json() : Json(c.cost_unit)}});
  return all;
}

nlohmann::json plan_json(const RenderPlan &plan) {
  return {{"size", plan.size},
          {"crop", plan.crop},
          {"wavelengths_nm", plan.wavelengths_nm},
          {"precision", plan.precision == Precision::double_ ? "double" : "float"},
          {"method", method_name(plan.method)},
          {"varies_along_surface", plan.section},
          {"bent_nm", plan.bent_nm},
          {"pixel_arcsec", plan.pixel_arcsec},
          {"transfer_entries", plan.entries},
          {"transfer_spacing_arcsec", plan.spacing_arcsec},
          {"device_bytes", plan.device_bytes},
          {"host_bytes", plan.host_bytes},
          {"choices", choices_json(plan.choices)},
          {"modelled", plan.modelled},
          {"left_out", plan.left_out}};
}

nlohmann::json report_json(const Scene &scene, const RenderPlan &plan, const RenderOptions &options,
                           const RenderReport &report, const Device &device, const CameraReport &camera,
                           const OutputSeconds &seconds) {
  return {{"scene", scene.name},
          {"title", scene.title},
          {"scene_hash", scene_hash(scene)},
          {"version", version()},
          {"seed", options.seed},
          {"straight", options.straight},
          {"exaggerate", scene.atmosphere.profile.exaggerate},
          {"device", device_json(device)},
          {"plan", plan_json(plan)},
          {"rays_launched", report.trace.rays},
          {"outcomes", outcomes_json(report.trace.outcomes)},
          {"steps", {{"accepted", report.trace.steps}, {"rejected", report.trace.rejected}}},
          {"bouguer_drift", report.trace.bouguer_drift},
          {"table",
           {{"cells", report.table_cells},
            {"transfer_entries", report.curve_entries},
            {"bound_arcsec", report.table_bound_arcsec},
            {"storage", report.table_in_image ? "image" : "buffer"}}},
          {"photons", {{"emitted", 0}, {"stored_diffuse", 0}, {"stored_caustic", 0}}},
          {"samples_per_pixel", report.spp},
          {"sun",
           {{"true_altitude_deg", optional(report.sun_true_altitude_deg)},
            {"apparent_altitude_deg", optional(report.sun_apparent_altitude_deg)},
            {"optical_depth", optional(report.sun_optical_depth)}}},
          {"horizon_altitude_deg", optional(report.horizon_altitude_deg)},
          {"error",
           {{"table_arcsec", report.table_arcsec},
            {"solver_arcsec", report.solver_arcsec},
            {"lookup_arcsec", report.lookup_arcsec},
            {"target_arcsec", optional(report.target_arcsec)},
            {"terrain_arcsec", optional(report.terrain_arcsec)},
            {"ground_arcsec", optional(report.ground_arcsec)},
            {"noise_rms", report.noise_rms},
            {"bias", report.bias},
            {"sky_azimuth", report.azimuth_error}}},
          {"camera", camera_json(camera)},
          {"seconds",
           {{"workers", report.workers},
            {"compile", report.compile_seconds},
            {"build", report.build_seconds},
            {"emit", report.emit_seconds},
            {"map", 0.0},
            {"gather", report.gather_seconds},
            {"eye", seconds.eye},
            {"total", seconds.total}}}};
}

}  // namespace greenray
