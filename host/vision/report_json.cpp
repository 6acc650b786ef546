#include "vision/report_json.hpp"

#include <nlohmann/json.hpp>

namespace greenray::vision {

using Json = nlohmann::json;

const char *name_of(PupilModel model) {
  switch (model) {
    case PupilModel::watson_yellott:
      return "watson-yellott";
    case PupilModel::de_groot:
      return "de-groot";
    case PupilModel::moon_spencer:
      return "moon-spencer";
    case PupilModel::g04:
      return "g04";
  }
  return "";
}

const char *name_of(BleachModel model) {
  switch (model) {
    case BleachModel::catch_:
      return "catch";
    case BleachModel::shape:
      return "shape";
    case BleachModel::threshold:
      return "threshold";
    case BleachModel::adapted:
      return "adapted";
  }
  return "";
}

namespace {

Json lms(const std::array<double, 3> &value) { return {{"L", value[0]}, {"M", value[1]}, {"S", value[2]}}; }

Json bleaching_json(const EyeReport &r, const BleachingOptions &o) {
  if (o.exposure == BleachingOptions::Exposure::off) return {{"exposure", "off"}};
  const bool steady = o.exposure == BleachingOptions::Exposure::steady;
  return {{"exposure", steady ? Json("steady") : Json(o.seconds)},
          {"model", name_of(o.model)},
          {"pool", o.pooled ? "disk" : "pixel"},
          {"half_bleach_td", o.pigment.half_bleach_td},
          {"time_constant_s", o.pigment.time_constant_s},
          {"least_unbleached", lms(r.least_unbleached)},
          {"pool_unbleached", lms(r.pool_unbleached)},
          {"spectra_assumed", r.spectra_assumed}};
}

Json greener_json(const GreenerStats &g) {
  return {{"pixels", g.pixels},
          {"hue_shift_deg", g.hue_shift_deg},
          {"delta_e2000", g.delta_e2000},
          {"largest_delta_e2000", g.largest_delta_e2000},
          {"changed_pixels", g.changed}};
}

}  // namespace

Json report_json(const EyeReport &r, const EyeOptions &o) {
  Json out{
      {"observer", "human"},
      {"pixels",
       {{"total", r.pixels},
        {"not_a_number", r.faults.not_a_number},
        {"infinite", r.faults.infinite},
        {"negative", r.faults.negative},
        {"too_bright", r.faults.too_bright},
        {"gamut_moved", r.gamut_moved}}},
      {"luminance_cd_m2",
       {{"least", r.least_cd_m2},
        {"most", r.most_cd_m2},
        {"mean", r.mean_cd_m2},
        {"fifth_percentile", r.fifth_percentile_cd_m2},
        {"adaptation", r.adaptation_cd_m2},
        {"surround", r.surround_cd_m2}}},
      {"view", {{"fov_deg", r.fov_deg}, {"assumed", r.fov_assumed}, {"magnification", o.magnification}}},
      {"tone",
       {{"ldmax_cd_m2", o.display.max_cd_m2},
        {"contrast", o.display.contrast},
        {"sensitivity", o.sensitivity},
        {"linear", r.linear},
        {"linear_scale", r.linear_scale},
        {"passes", r.tone_passes},
        {"histogram_low_cd_m2", r.histogram_low_cd_m2},
        {"histogram_high_cd_m2", r.histogram_high_cd_m2},
        {"foveal_samples", r.foveal}}},
      {"pupil",
       {{"model", name_of(o.pupil)},
        {"diameter_mm", r.pupil_mm},
        {"effectivity", r.effectivity},
        {"field_cd_m2", r.field_cd_m2},
        {"field_deg2", r.field_deg2},
        {"td_per_cd_m2", r.td_per_cd_m2}}},
      {"glare", {{"applied", r.glare_applied}, {"age_years", o.eye.age_years}, {"pigmentation", o.eye.pigmentation}}},
      {"acuity", {{"applied", r.acuity_applied}, {"coarsest_sample_pixels", r.coarsest_sample_pixels}}},
      {"colour", {{"rods_applied", r.rods_applied}}},
      {"bleaching", bleaching_json(r, o.bleaching)},
      {"streamed", !r.kept_in_memory}};
  if (o.map_greener) out["greener"] = greener_json(r.greener);
  return out;
}

}  // namespace greenray::vision
