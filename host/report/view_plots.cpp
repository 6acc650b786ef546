#include "report/view_plots.hpp"

#include <algorithm>
#include <cmath>

namespace greenray {
namespace {

const char *const sky_colour = "#2f6db5", *const ground_colour = "#8a6d3b", *const held_colour = "#c0392b",
                  *const straight_colour = "#888888";

/// Metres, or kilometres for long ones.
struct LengthUnit {
  explicit LengthUnit(double largest_m) : metres(largest_m > 5000 ? 1000 : 1), name(largest_m > 5000 ? "km" : "m") {}
  double metres;
  const char *name;
  double operator()(double length_m) const { return length_m / metres; }
};

std::string and_exaggerated(const ViewDiagnosis &view) {
  return view.exaggerate == 1 ? "" : "; n − 1 exaggerated " + plain_number(view.exaggerate, 6) + " times";
}

std::string nm(double wavelength_nm) { return plain_number(wavelength_nm, 5) + " nm"; }

void shade(PlotPanel &panel, const ViewDiagnosis &view, const LengthUnit &unit) {
  for (const Duct &duct : view.air.ducts) {
    panel.bands.push_back({unit(duct.bottom_m), unit(duct.top_m), "duct"});
    panel.bands.push_back({unit(duct.trapping_bottom_m), unit(duct.top_m), ""});
  }
  for (const SuperadiabaticLayer &layer : view.air.superadiabatic)
    panel.bands.push_back({unit(layer.bottom_m), unit(layer.top_m), "bends upwards", "#6aaed6"});
  panel.levels.push_back({unit(view.height_m), "eye"});
}

/// The part of the view worth drawing [deg].
struct Window {
  double low, high;  // apparent
  double low_true, high_true;
};

double true_at(const Mirages &m, double apparent_deg) {
  for (std::size_t i = 0; i + 1 < m.apparent_deg.size(); ++i) {
    const double a = m.apparent_deg[i], b = m.apparent_deg[i + 1];
    if (apparent_deg >= a && apparent_deg <= b && b > a)
      return m.true_deg[i] + (m.true_deg[i + 1] - m.true_deg[i]) * (apparent_deg - a) / (b - a);
  }
  return apparent_deg;
}

Window window_of(const ViewDiagnosis &view) {
  const Mirages &m = view.mirages.front();
  double low = 0, high = 0;
  bool any = false;
  const auto reach = [&](double altitude) {
    if (!(std::abs(altitude) < 89)) return;
    low = any ? std::min(low, altitude) : altitude, high = any ? std::max(high, altitude) : altitude;
    any = true;
  };
  for (const FateBand &band : m.fates) reach(band.low_deg);
  for (const Fold &fold : m.folds) reach(fold.apparent_altitude_deg);
  const double span = std::max(m.folds.empty() ? 0.5 : 0.12, high - low);
  Window w{low - 0.2 * span, high + 0.6 * span, 0, 0};
  w.high_true = true_at(m, w.high), w.low_true = w.high_true;
  for (const Fold &fold : m.folds) {
    w.low_true = std::min(w.low_true, fold.true_altitude_deg);
    w.high_true = std::max(w.high_true, fold.true_altitude_deg);
  }
  for (const Branch &b : m.branches)
    for (const double end : {b.true_at_low_deg, b.true_at_high_deg})
      if (std::isfinite(end) && end < 89 && b.low_deg < w.high) w.low_true = std::min(w.low_true, end);
  const double true_span = std::max(w.high_true - w.low_true, 0.2);
  w.low_true -= 0.25 * true_span, w.high_true += 0.05 * true_span;
  return w;
}

void shade_fates(PlotPanel &panel, const Mirages &m, const Window &w) {
  for (const FateBand &band : m.fates) {
    if (band.outcome == f64::RAY_SPACE || band.high_deg < w.low || band.low_deg > w.high) continue;
    const bool ground = band.outcome == f64::RAY_GROUND;
    panel.bands.push_back({std::max(band.low_deg, w.low), std::min(band.high_deg, w.high),
                           ground                             ? "ground"
                           : band.outcome == f64::RAY_TRAPPED ? "held in a duct"
                                                              : "not followed",
                           ground ? "#9a8560" : "#c0392b"});
  }
}

/// Middle of a branch as far as it is drawn.
PlotLabel number_of(const Branch &b, const Mirages &m, const Window &w) {
  const double low = std::max(b.low_deg, w.low), high = std::min(b.high_deg, w.high);
  double at = 0.5 * (low + high);
  for (int k = 0; k < 40 && true_at(m, at) < w.low_true; ++k)  // beside a duct's edge most of it is far below
    at = std::isfinite(b.true_at_low_deg) ? 0.5 * (low + at) : 0.5 * (high + at);
  return {true_at(m, at), at, std::to_string(b.number) + (b.erect ? "" : "↓"), b.erect ? "#1b4f86" : "#9b2d20"};
}

std::string expectation(const ViewDiagnosis &view) { return view.air.expect.empty() ? "" : view.air.expect.front(); }

const char *fate_colour(int outcome) {
  return outcome == f64::RAY_SPACE ? sky_colour : outcome == f64::RAY_GROUND ? ground_colour : held_colour;
}
const char *fate_words(int outcome) {
  return outcome == f64::RAY_SPACE     ? "to the sky"
         : outcome == f64::RAY_GROUND  ? "to the ground"
         : outcome == f64::RAY_TRAPPED ? "held in a duct"
                                       : "not followed to its end";
}

}  // namespace

Plot air_figure(const ViewDiagnosis &view) {
  const LengthUnit unit(view.top_m);
  PlotLine temperature{"", "#b5382a", {}, {}}, n{"", "#2e7d57", {}, {}}, m{"", "#3d5a80", {}, {}};
  for (const AirRow &row : view.rows) {
    const double h = unit(row.height_m);
    temperature.x.push_back(row.temperature_K), temperature.y.push_back(h);
    n.x.push_back(row.refractivity_N), n.y.push_back(h);
    m.x.push_back(row.modified_M), m.y.push_back(h);
  }
  Plot plot;
  plot.title = "The air: " + view.profile;
  plot.subtitle = expectation(view) + and_exaggerated(view);
  const bool is_air = !view.rows.empty() && std::isfinite(view.rows.front().temperature_K);
  if (is_air) plot.panels.push_back({{"temperature", "K"}, {"", ""}, {temperature}, {}, {}});
  plot.panels.push_back({{"refractivity N = 10⁶ (n − 1)", ""}, {"", ""}, {n}, {}, {}});
  plot.panels.push_back({{"modified M = N + 10⁶ h/R", ""}, {"", ""}, {m}, {}, {}});
  for (PlotPanel &panel : plot.panels) {
    panel.y = {"", "", false, 0.0, unit(view.top_m)};
    shade(panel, view, unit);
  }
  plot.panels.front().y.label = "height above the surface";
  plot.panels.front().y.unit = unit.name;
  plot.panel_width = is_air ? 236 : 392;
  plot.panel_height = 300;
  plot.legend = false;
  return plot;
}

Plot fan_figure(const ViewDiagnosis &view) {
  double farthest_m = 1, highest_m = 0;
  for (const FanRay &ray : view.fan) {
    farthest_m = std::max(farthest_m, ray.distance_m.back());
    highest_m = std::max(highest_m, *std::max_element(ray.height_m.begin(), ray.height_m.end()));
  }
  double top_m = std::min(
      highest_m, std::max(2.5 * view.height_m, view.air.ducts.empty() ? 0 : 1.5 * view.air.ducts.back().top_m));
  if (view.sight) top_m = std::max(top_m, 1.3 * view.sight->target_height_m);
  top_m = std::max(top_m, 1.0);
  const LengthUnit along(farthest_m), up(top_m);
  PlotPanel panel{{"distance along the surface", along.name, false, 0.0, along(farthest_m)},
                  {"height above the surface", up.name, false, 0.0, up(top_m)},
                  {},
                  {},
                  {}};
  for (const FanRay &ray : view.fan) {
    PlotLine line{fate_words(ray.outcome), fate_colour(ray.outcome), {}, {}, false, 1.0};
    for (std::size_t i = 0; i < ray.distance_m.size(); ++i)
      line.x.push_back(along(ray.distance_m[i])), line.y.push_back(up(ray.height_m[i]));
    panel.lines.push_back(std::move(line));
  }
  if (view.sight) {
    const double x = along(view.sight->distance_m),
                 hidden = std::min(view.sight->hidden_m, view.sight->target_height_m);
    panel.lines.push_back({"target, hidden", "#999999", {x, x}, {0, up(hidden)}, false, 6});
    panel.lines.push_back(
        {"target, visible", "#1b7f3b", {x, x}, {up(hidden), up(view.sight->target_height_m)}, false, 6});
  }
  shade(panel, view, up);
  Plot plot;
  plot.panel_width = 860, plot.panel_height = 360;
  const double times = farthest_m / plot.panel_width / (top_m / plot.panel_height);
  plot.title =
      "Rays of sight, every " +
      plain_angle((view.fan.at(1).apparent_altitude_deg - view.fan.at(0).apparent_altitude_deg) * 0.017453292519943295);
  plot.subtitle = std::string(view.flat ? "flat surface" : "the curvature of the Earth is taken out") + ", heights " +
                  plain_number(times, 3) + " times exaggerated, eye at " + plain_number(view.height_m, 4) + " m, " +
                  nm(view.fan_wavelength_nm) + and_exaggerated(view);
  plot.panels.push_back(std::move(panel));
  return plot;
}

Plot transfer_figure(const ViewDiagnosis &view) {
  const Mirages &m = view.mirages.front();
  const Window w = window_of(view);
  PlotPanel panel{{"true altitude, without air", "deg", false, w.low_true, w.high_true},
                  {"seen altitude", "deg", false, w.low, w.high},
                  {},
                  {},
                  {}};
  for (const Mirages &each : view.mirages)
    panel.lines.push_back(
        {nm(each.wavelength_nm), wavelength_colour(each.wavelength_nm), each.true_deg, each.apparent_deg});
  const double low = std::max(w.low, w.low_true), high = std::min(w.high, w.high_true);
  if (low < high) panel.lines.push_back({"no refraction", straight_colour, {low, high}, {low, high}, true, 1.1});
  PlotLine folds{"fold", "#111111", {}, {}, false, 0, PlotMarker::disc, true};
  for (const Fold &fold : m.folds) {
    folds.x.push_back(fold.true_altitude_deg), folds.y.push_back(fold.apparent_altitude_deg);
    folds.notes.push_back("fold " + std::to_string(fold.number) + ": seen " +
                          plain_number(fold.apparent_altitude_deg, 6) + " deg, true " +
                          plain_number(fold.true_altitude_deg, 6) + " deg");
  }
  if (!folds.x.empty()) panel.lines.push_back(std::move(folds));
  shade_fates(panel, m, w);
  if (view.horizon_deg) panel.levels.push_back({*view.horizon_deg, "horizon"});
  for (const Branch &b : m.branches)
    if (b.low_deg < w.high && b.high_deg > w.low) panel.labels.push_back(number_of(b, m, w));
  Plot plot;
  plot.title = "Transfer curve";
  plot.subtitle = std::to_string(m.branches.size()) +
                  (m.branches.size() == 1 ? " branch, " : " branches (↓ upside down), ") +
                  std::to_string(m.folds.size()) + (m.folds.size() == 1 ? " fold, " : " folds, ") + "at most " +
                  std::to_string(m.most_images) + (m.most_images == 1 ? " image" : " images") + " of one point, at " +
                  nm(m.wavelength_nm) + and_exaggerated(view);
  plot.panel_width = 860, plot.panel_height = 420;
  plot.panels.push_back(std::move(panel));
  return plot;
}

Plot count_figure(const ViewDiagnosis &view) {
  const Mirages &m = view.mirages.front();
  const Window w = window_of(view);
  PlotLine steps{"", "#1b4f86", {}, {}, false, 2};
  const auto add = [&](double x, int images) { steps.x.push_back(x), steps.y.push_back(images); };
  if (m.counts.empty() || m.counts.front().low_true_deg > w.low_true) {
    add(w.low_true, 0);
    if (!m.counts.empty()) add(m.counts.front().low_true_deg, 0);
  }
  for (const ImageCount &c : m.counts)
    add(std::max(c.low_true_deg, w.low_true - 1), c.images), add(c.high_true_deg, c.images);
  Plot plot;
  plot.title = "Images of each true altitude";
  plot.subtitle = "how often light from one altitude outside the air reaches the eye, at " + nm(m.wavelength_nm);
  plot.panel_width = 860, plot.panel_height = 110, plot.legend = false;
  plot.panels.push_back({{"true altitude, without air", "deg", false, w.low_true, w.high_true},
                         {"images", "", false, 0.0, std::max(m.most_images, 4) + 0.5},
                         {steps},
                         {},
                         {}});
  return plot;
}

std::string view_sheet(const ViewDiagnosis &view, const std::optional<Plot> &rays) {
  return draw_svg(
      std::vector<Plot>{air_figure(view), rays ? *rays : fan_figure(view), transfer_figure(view), count_figure(view)});
}

}  // namespace greenray
