#include "report/view_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace greenray {
namespace {

using Json = nlohmann::json;

/// null for what is not a finite number.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }
Json number(const std::optional<double> &value) { return value ? number(*value) : Json(); }

Json numbers(const std::vector<double> &values) {
  Json all = Json::array();
  for (const double v : values) all.push_back(number(v));
  return all;
}

Json mirages_json(const Mirages &m) {
  Json fates = Json::array(), folds = Json::array(), branches = Json::array(), counts = Json::array();
  for (const FateBand &f : m.fates)
    fates.push_back({{"low_deg", f.low_deg}, {"high_deg", f.high_deg}, {"status", outcome_name(f.outcome)}});
  for (const Fold &f : m.folds)
    folds.push_back({{"number", f.number},
                     {"apparent_altitude_deg", f.apparent_altitude_deg},
                     {"true_altitude_deg", f.true_altitude_deg},
                     {"kind", f.highest ? "maximum" : "minimum"}});
  for (const Branch &b : m.branches)
    branches.push_back({{"number", b.number},
                        {"low_deg", b.low_deg},
                        {"high_deg", b.high_deg},
                        {"true_at_low_deg", number(b.true_at_low_deg)},
                        {"true_at_high_deg", number(b.true_at_high_deg)},
                        {"erect", b.erect},
                        {"low_end", branch_end_name(b.low_end)},
                        {"high_end", branch_end_name(b.high_end)}});
  for (const ImageCount &c : m.counts)
    counts.push_back(
        {{"low_true_deg", number(c.low_true_deg)}, {"high_true_deg", c.high_true_deg}, {"images", c.images}});
  return {{"wavelength_nm", m.wavelength_nm},
          {"bands", fates},
          {"folds", folds},
          {"branches", branches},
          {"image_counts", counts},
          {"most_images", m.most_images},
          {"least_fold_arcsec", m.least_fold_arcsec},
          {"curve", {{"apparent_altitude_deg", numbers(m.apparent_deg)}, {"true_altitude_deg", numbers(m.true_deg)}}}};
}

Json images_json(const std::vector<SightImage> &images) {
  Json all = Json::array();
  for (const SightImage &i : images)
    all.push_back({{"apparent_altitude_deg", i.apparent_altitude_deg},
                   {"erect", i.erect},
                   {"refraction_arcsec", i.refraction_arcsec},
                   {"k_of_refraction", i.k_of_refraction},
                   {"k_of_path", i.k_of_path}});
  return all;
}

Json sight_json(const SightLine &s) {
  return {{"distance_m", s.distance_m},
          {"target_height_m", s.target_height_m},
          {"geometric_altitude_deg", s.geometric_altitude_deg},
          {"hidden_height_m", number(s.hidden_m)},
          {"hidden_height_straight_m", number(s.hidden_straight_m)},
          {"hidden_height_k013_m", number(s.hidden_k013_m)},
          {"visible_m", s.visible_m()},
          {"images_of_top", images_json(s.top)},
          {"images_of_base", images_json(s.base)}};
}

Json rows_json(const std::vector<AirRow> &rows) {
  std::vector<double> h, t, p, n, m, k;
  for (const AirRow &r : rows) {
    h.push_back(r.height_m), t.push_back(r.temperature_K), p.push_back(r.pressure_Pa);
    n.push_back(r.refractivity_N), m.push_back(r.modified_M), k.push_back(r.k);
  }
  return {{"height_m", numbers(h)},       {"temperature_K", numbers(t)}, {"pressure_Pa", numbers(p)},
          {"refractivity_N", numbers(n)}, {"modified_M", numbers(m)},    {"k", numbers(k)}};
}

Json fan_json(const ViewDiagnosis &v) {
  Json rays = Json::array();
  for (const FanRay &r : v.fan)
    rays.push_back({{"apparent_altitude_deg", r.apparent_altitude_deg},
                    {"status", outcome_name(r.outcome)},
                    {"distance_m", numbers(r.distance_m)},
                    {"height_m", numbers(r.height_m)}});
  return {{"wavelength_nm", v.fan_wavelength_nm}, {"rays", rays}};
}

}  // namespace

nlohmann::json air_json(const Diagnosis &air) {
  Json ducts = Json::array(), inversions = Json::array(), rising = Json::array();
  for (const Duct &d : air.ducts)
    ducts.push_back({{"bottom_m", d.bottom_m},
                     {"trapping_bottom_m", d.trapping_bottom_m},
                     {"top_m", d.top_m},
                     {"index_drop", d.index_drop},
                     {"widest_trapped_deg", d.widest_trapped_deg}});
  for (const Inversion &v : air.inversions)
    inversions.push_back({{"bottom_m", v.bottom_m},
                          {"top_m", v.top_m},
                          {"rise_K", v.rise_K},
                          {"steepest_K_m", v.steepest_K_m},
                          {"largest_curvature", v.largest_curvature}});
  for (const SuperadiabaticLayer &s : air.superadiabatic)
    rising.push_back(
        {{"bottom_m", s.bottom_m}, {"top_m", s.top_m}, {"fall_K", s.fall_K}, {"index_rise", s.index_rise}});
  return {{"curvature_at_ground", air.curvature_at_ground},
          {"ducts", ducts},
          {"inversions", inversions},
          {"superadiabatic", rising},
          {"expect", air.expect}};
}

nlohmann::json view_json(const ViewDiagnosis &v) {
  Json transfer = Json::array();
  for (const Mirages &m : v.mirages) transfer.push_back(mirages_json(m));
  Json out{{"profile", v.profile},
           {"height_m", v.height_m},
           {"surface", v.flat ? "flat" : "sphere"},
           {"earth_radius_m", v.earth_radius_m},
           {"exaggerate", v.exaggerate},
           {"varies_along_surface", v.varies},
           {"air", air_json(v.air)},
           {"k_at_eye", number(v.k_at_eye)},
           {"horizon",
            {{"apparent_altitude_deg", number(v.horizon_deg)},
             {"distance_m", number(v.horizon_m)},
             {"geometric_altitude_deg", number(v.geometric_horizon_deg)},
             {"geometric_distance_m", number(v.geometric_horizon_m)}}},
           {"transfer", transfer},
           {"layers", rows_json(v.rows)},
           {"fan", fan_json(v)},
           {"target", v.sight ? sight_json(*v.sight) : Json()}};
  return out;
}

}  // namespace greenray
