#include "cli/air_plot.hpp"

#include <algorithm>
#include <cmath>

#include "atmosphere/standard_atmosphere.hpp"
#include "compute/ray_tracer.hpp"
#include "support/angle.hpp"

namespace greenray::cli {
namespace {

constexpr double all_weather_m = 30000;
constexpr int heights = 500;

/// Heights in metres, or in kilometres for a tall picture.
struct HeightUnit {
  explicit HeightUnit(double top_m) : metres(top_m > 5000 ? 1000 : 1), name(top_m > 5000 ? "km" : "m") {}
  double metres;
  const char *name;
  double operator()(double height_m) const { return height_m / metres; }
};

/// An even net with kinks from both sides, and features.
std::vector<double> drawn_heights(const Profile &profile, double top_m) {
  std::vector<double> all;
  for (int i = 0; i <= heights; ++i) all.push_back(top_m * i / heights);
  const auto add = [&](double h) {
    if (h > 0 && h < top_m) all.push_back(h);
  };
  for (const double kink : profile.kinks_m()) add(kink * (1 - 1e-9)), add(kink * (1 + 1e-9));
  for (const double feature : profile.features_m()) add(feature);
  std::sort(all.begin(), all.end());
  return all;
}

void shade(PlotPanel &panel, const Diagnosis &diagnosis, const HeightUnit &unit, std::optional<double> eye_height_m) {
  for (const Duct &duct : diagnosis.ducts) {
    panel.bands.push_back({unit(duct.bottom_m), unit(duct.top_m), "duct"});
    panel.bands.push_back({unit(duct.trapping_bottom_m), unit(duct.top_m), ""});
  }
  for (const SuperadiabaticLayer &layer : diagnosis.superadiabatic)
    panel.bands.push_back({unit(layer.bottom_m), unit(layer.top_m), "bends upwards", "#6aaed6"});
  if (eye_height_m) panel.levels.push_back({unit(*eye_height_m), "eye"});
}

std::string nm(double wavelength_nm) { return plain_number(wavelength_nm, 5) + " nm"; }

}  // namespace

double plot_top_m(const Profile &profile, const Diagnosis &diagnosis, std::optional<double> eye_height_m) {
  const ProfileSpec &spec = profile.spec();
  if (!profile.is_air()) return std::max(spec.index_levels.back().height_m, eye_height_m.value_or(0) * 1.2);
  constexpr double low_m = 3000;  // soundings have small inversions all the way up
  double highest = 0;
  const auto reach = [&](double h) {
    if (h < low_m) highest = std::max(highest, h);
  };
  for (const Duct &duct : diagnosis.ducts) reach(duct.top_m);
  for (const SuperadiabaticLayer &layer : diagnosis.superadiabatic) reach(layer.top_m);
  for (const InversionSpec &v : spec.inversions)
    highest = std::max(highest, v.height_m.constant() + 5 * v.diffuseness_m.constant());
  for (const SurfaceLayerSpec &layer : spec.surface_layers) highest = std::max(highest, 6 * layer.scale_m);
  if (!spec.levels.empty())
    for (const Inversion &v : diagnosis.inversions)
      if (v.rise_K > 0.3) reach(v.top_m);
  const double top = highest > 0 ? 2.5 * highest : all_weather_m;
  return std::clamp(std::max(top, 1.2 * eye_height_m.value_or(0)), 0.1, us76::air_top_m);
}

Plot air_plot(const Profile &profile, const Diagnosis &diagnosis, const std::vector<double> &wavelengths_nm,
              std::optional<double> eye_height_m) {
  const double top_m = plot_top_m(profile, diagnosis, eye_height_m);
  const HeightUnit unit(top_m);
  const std::vector<double> h = drawn_heights(profile, std::min(top_m, profile.top_m(!profile.is_air())));
  PlotLine temperature{"", "#b5382a", {}, {}}, pressure{"", "#3d5a80", {}, {}};
  PlotPanel index{{"n − 1", ""}, {"", ""}, {}, {}, {}}, gradient{{"d(n − 1)/dh", "m⁻¹"}, {"", ""}, {}, {}, {}};
  std::vector<double> drawn;
  for (const double height_m : h) drawn.push_back(unit(height_m));
  if (profile.is_air())
    for (const double height_m : h) {
      const AirState air = profile.air(height_m);
      temperature.x.push_back(air.temperature_K.value);
      pressure.x.push_back(air.pressure_Pa.value);
    }
  temperature.y = pressure.y = drawn;
  for (const double wavelength_nm : wavelengths_nm) {
    PlotLine value{nm(wavelength_nm), wavelength_colour(wavelength_nm), {}, drawn}, slope = value;
    for (const double height_m : h) {
      const Dual refractivity = profile.refractivity(height_m, wavelength_nm);
      value.x.push_back(refractivity.value);
      slope.x.push_back(refractivity.slope);
    }
    index.lines.push_back(value);
    gradient.lines.push_back(slope);
  }
  PlotLine limit{"traps light", "#555555", {}, drawn, true, 1.1};
  for (const double height_m : h)
    limit.x.push_back(-(1 + profile.refractivity(height_m, diagnosis_wavelength_nm).value) /
                      (profile.spec().earth_radius_m + height_m));
  gradient.lines.push_back(limit);

  Plot plot;
  plot.title = profile.spec().name + ": the air and its light";
  plot.subtitle = diagnosis.expect.front();
  if (profile.spec().exaggerate != 1)
    plot.subtitle += "; n − 1 exaggerated " + plain_number(profile.spec().exaggerate, 6) + " times";
  if (profile.is_air()) {
    plot.panels.push_back({{"temperature", "K"}, {"", ""}, {temperature}, {}, {}});
    plot.panels.push_back({{"pressure", "Pa", true}, {"", ""}, {pressure}, {}, {}});
  }
  plot.panels.push_back(index);
  plot.panels.push_back(gradient);
  for (PlotPanel &panel : plot.panels) {
    panel.y = {"", "", false, 0.0, unit(top_m)};
    shade(panel, diagnosis, unit, eye_height_m);
  }
  plot.panels.front().y.label = "height above the surface";
  plot.panels.front().y.unit = unit.name;
  return plot;
}

Plot ray_plot(const std::vector<TraceRow> &rows, const TraceRequest &request, const Profile &profile) {
  double longest_m = 0, highest_m = 0;
  for (const TraceRow &row : rows) {
    longest_m = std::max(longest_m, row.distance_m);
    if (std::isfinite(row.height_m)) highest_m = std::max(highest_m, row.height_m);
  }
  const HeightUnit up(highest_m), along(longest_m);
  PlotPanel panel{{"distance along the surface", along.name, false, 0.0, along(longest_m)},
                  {"height above the surface", up.name},
                  {},
                  {},
                  {}};
  const std::size_t per_ray = request.distances_m.size();
  for (std::size_t start = 0; start + per_ray <= rows.size(); start += per_ray) {
    const double wavelength_nm = rows[start].wavelength_nm;
    PlotLine line{nm(wavelength_nm), wavelength_colour(wavelength_nm), {}, {}, false, 1.1};
    for (std::size_t i = start; i < start + per_ray; ++i) {
      const TraceRow &row = rows[i];
      const bool here = row.outcome == f64::RAY_IN_FLIGHT || row.outcome == f64::RAY_TRAPPED;
      double distance_m = row.distance_m;
      if (!here && i > start) {
        const TraceRow &before = rows[i - 1];
        const double mean = std::tan(to_rad(0.5 * (before.elevation_deg + row.elevation_deg)));
        const double run = mean == 0 ? 0 : (row.height_m - before.height_m) / mean;
        distance_m = std::clamp(before.distance_m + run, before.distance_m, row.distance_m);
      }
      line.x.push_back(along(distance_m));
      line.y.push_back(up(row.height_m));
      if (!here) break;
    }
    panel.lines.push_back(std::move(line));
  }
  const Diagnosis diagnosis = diagnose(profile, request.height_m);
  shade(panel, diagnosis, up, request.height_m);
  Plot plot;
  plot.title = "Rays through " + profile.spec().name;
  plot.subtitle = std::string(request.flat ? "flat surface" : "height above the sphere (its curvature is taken out)") +
                  ", eye at " + plain_number(request.height_m, 4) + " m";
  if (profile.spec().exaggerate != 1)
    plot.subtitle += ", n − 1 exaggerated " + plain_number(profile.spec().exaggerate, 6) + " times";
  plot.panel_width = 860;
  plot.panel_height = 460;
  plot.panels.push_back(std::move(panel));
  return plot;
}

}  // namespace greenray::cli
