#include "render/room_report.hpp"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "render/report.hpp"
#include "render/room_looks.hpp"
#include "render/room_plan.hpp"
#include "render/room_sun.hpp"
#include "support/version.hpp"

namespace greenray {

using Json = nlohmann::json;

namespace {

std::string rounded(double value, int digits) {
  std::ostringstream text;
  text << std::setprecision(digits) << value;
  return text.str();
}

Json sun_json(const RoomScene &scene) {
  const LightScene *light = sun_of(scene);
  if (!light) return Json();
  const std::vector<double> nm = room_wavelengths(scene);
  const RoomSun sun = sun_through_air(scene, *light, nm), at_550 = sun_through_air(scene, *light, {550});
  return {{"true_altitude_deg", sun.true_altitude_deg},
          {"apparent_altitude_deg", sun.apparent_altitude_deg},
          {"air_mass", sun.air_mass},
          {"optical_depth", at_550.optical_depth[0]},
          {"wavelength_nm", nm},
          {"irradiance_W_m2_nm", sun.irradiance_W_m2_nm}};
}

void describe_suns(const RoomScene &scene, std::vector<std::string> &modelled, std::vector<std::string> &left_out) {
  for (const LightScene &light : scene.lights) {
    if (light.kind == LightScene::Kind::sun && !light.through_air)
      left_out.emplace_back("air above the scene: the Sun's irradiance_W_m2 is what arrives");
    if (!light.through_air) continue;
    const RoomSun sun = sun_through_air(scene, light, {550});
    modelled.push_back("the Sun through the air above (" + scene.above.profile.name + "): centre at true altitude " +
                       rounded(sun.true_altitude_deg, 5) + " deg, seen at " + rounded(sun.apparent_altitude_deg, 5) +
                       " deg, air mass " + rounded(sun.air_mass, 4) + ", optical depth " +
                       rounded(sun.optical_depth[0], 3) + " at 550 nm, " +
                       (scene.above.extinction ? "Rayleigh, ozone and aerosol" : "extinction off") +
                       (light.limb_darkening ? ", limb darkening" : ""));
    left_out.emplace_back("light of the sky; the flattening of a low Sun");
  }
}

}  // namespace

Json room_plan_json(const RoomScene &scene, const RoomOptions &options) {
  std::vector<std::string> modelled{"light on Lambert surfaces, direct and indirect: photon map",
                                    "mirrors, glass and rough surfaces: followed by photons and by the eye"};
  std::vector<std::string> left_out;
  if (scene.air && !options.straight) modelled.emplace_back("curved paths: chains of parabolas, L/n^2 carried");
  else left_out.push_back(options.straight ? "bending: --straight" : "bending: the scene has no medium");
  describe_suns(scene, modelled, left_out);
  left_out.emplace_back("scattering in the medium");
  left_out.emplace_back(
      "light that photons of wavelengths other than their leader would take on parted ways, below a two-hundredth of "
      "the scene");
  const RoomPlan plan = plan_room(scene, options);
  return {{"size", plan.size},
          {"crop", plan.crop},
          {"spp", plan.open ? Json() : Json(plan.samples * plan.passes)},
          {"passes", plan.open ? Json() : Json(plan.passes)},
          {"photons", plan.open ? Json() : Json(plan.photons)},
          {"photons_a_pass", plan.photons_a_pass},
          {"error_pct", options.error_pct ? Json(*options.error_pct) : Json()},
          {"minutes", options.minutes ? Json(*options.minutes) : Json()},
          {"gather", scene.photons.gather},
          {"modelled", modelled},
          {"left_out", left_out}};
}

Json room_report_json(const RoomScene &scene, const RoomOptions &options, const RoomReport &r, const Device &device,
                      double develop_seconds, double total_seconds) {
  const PhotonTotals &p = r.photons;
  const double passes = std::max(r.passes, 1);
  return {
      {"scene", scene.name},
      {"title", scene.title},
      {"scene_hash", room_hash(scene)},
      {"version", version()},
      {"seed", options.seed},
      {"straight", options.straight},
      {"sun", sun_json(scene)},
      {"exaggerate", scene.air ? scene.air->exaggerate : 1.0},
      {"device", device_json(device)},
      {"plan", room_plan_json(scene, options)},
      {"rays_launched", p.photons},
      {"outcomes",
       {{"absorbed", p.outcome[0]}, {"escaped", p.outcome[1]}, {"limit", p.outcome[2]}, {"not-finite", p.outcome[3]}}},
      {"photons",
       {{"emitted", p.photons},
        {"stored_diffuse", p.stored[0]},
        {"stored_caustic", p.stored[1]},
        {"aimed_cells", r.aimed_cells},
        {"path_pieces", p.pieces}}},
      {"energy_W_nm",
       {{"emitted", p.emitted / passes},
        {"absorbed", p.absorbed / passes},
        {"escaped", p.escaped / passes},
        {"medium", p.medium / passes},
        {"dropped", p.dropped / passes}}},
      {"surfaces", {{"triangles", r.triangles}, {"spheres", r.spheres}}},
      {"medium", {{"cells", r.air_cells}, {"error_m", r.table_error_m}}},
      {"samples_per_pixel", r.spp},
      {"passes",
       {{"count", r.passes},
        {"photons_each", r.photons_a_pass},
        {"from_checkpoint", r.resumed_at},
        {"pixels_at_lamp_edges", r.lamp_pixels},
        {"pixels_at_edges", r.edge_pixels}}},
      {"error",
       {{"table_m", r.table_error_m},
        {"table_arcsec", r.table_arcsec},
        {"solver_arcsec", r.solver_arcsec},
        {"noise_rms", r.noise_rms},
        {"bias", r.bias_rms},
        {"bias_below", r.bias_below},
        {"bias_mean", r.bias_mean},
        {"total_rms", r.error_rms},
        {"total_of_rms", r.error_of_rms}}},
      {"seconds",
       {{"compile", r.compile_seconds},
        {"build", r.build_seconds},
        {"emit", r.emit_seconds},
        {"map", r.map_seconds},
        {"gather", r.gather_seconds},
        {"eye", r.eye_seconds},
        {"develop", develop_seconds},
        {"total", total_seconds}}}};
}

}  // namespace greenray
