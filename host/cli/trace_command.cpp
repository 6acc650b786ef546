// greenray trace: where rays are after given distances along the surface; without a list of altitudes, all about a
// view.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "atmosphere/profile_file.hpp"
#include "cli/air_plot.hpp"
#include "cli/commands.hpp"
#include "cli/view_command.hpp"
#include "render/refraction.hpp"
#include "render/solver_choice.hpp"
#include "report/view_plots.hpp"
#include "support/atomic_file.hpp"
#include "support/version.hpp"

namespace greenray::cli {
namespace {

const std::vector<std::string> methods{"auto", "rk", "richardson", "cells", "section"};

TraceRequest request_from(const Arguments &a, const ProfileSpec &air) {
  TraceRequest request;
  request.height_m = a.number("--height", 0, 1e7, "m above the surface");
  request.altitudes_deg = a.list("--altitudes", -90, 90, "degrees");
  request.wavelengths_nm = a.list("--wavelengths", 200, 2000, "nm");
  request.distances_m = a.list("--distances", 0, 1e8, "m along the surface");
  request.precision = precision_of(a, Precision::double_);
  request.flat = a.choice("--surface", {"sphere", "flat"}, "sphere") == "flat";
  const std::string method = a.choice("--method", methods, "auto");
  const SolverChoice choice = choose_solver(air, method, a.place("--method"));
  request.method = choice.method;
  request.section = choice.section;
  request.azimuth_rad = azimuth_from_path_rad(a, air);
  const bool single = request.precision == Precision::single_;
  request.tolerance_arcsec = a.optional_number("--tolerance", 1e-6, 3600, "arcsec")
                                 .value_or(single                   ? 1e-3
                                           : method == "richardson" ? 1e-3
                                                                    : 1e-6);
  return request;
}

std::string as_csv(const std::vector<TraceRow> &rows, const TraceRequest &request, const AirSection &profile) {
  std::ostringstream out;
  out << "# greenray " << version() << " trace, profile " << profile.spec().name << ", eye at "
      << digits(request.height_m) << " m, " << (request.flat ? "flat" : "sphere") << "\n";
  if (has_places(profile.spec())) out << "# solver: " << solver_words(profile.spec(), request.section) << "\n";
  if (profile.spec().exaggerate != 1)
    out << "# the refractivity is exaggerated " << digits(profile.spec().exaggerate) << " times\n";
  out << "apparent_altitude_deg,wavelength_nm,distance_m,status,height_m,elevation_deg,bending_arcsec,optical_path_m\n";
  for (const TraceRow &r : rows)
    out << digits(r.apparent_altitude_deg) << ',' << digits(r.wavelength_nm) << ',' << digits(r.distance_m) << ','
        << outcome_name(r.outcome) << ',' << digits(r.height_m) << ',' << digits(r.elevation_deg) << ','
        << digits(r.bending_arcsec) << ',' << digits(r.optical_path_m) << '\n';
  return out.str();
}

std::string as_json(const std::vector<TraceRow> &rows, const TraceRequest &request, const AirSection &profile) {
  nlohmann::json out{{"version", version()},
                     {"profile", profile.spec().name},
                     {"height_m", request.height_m},
                     {"surface", request.flat ? "flat" : "sphere"},
                     {"exaggerate", profile.spec().exaggerate},
                     {"rows", nlohmann::json::array()}};
  for (const TraceRow &r : rows)
    out["rows"].push_back({{"apparent_altitude_deg", r.apparent_altitude_deg},
                           {"wavelength_nm", r.wavelength_nm},
                           {"distance_m", r.distance_m},
                           {"status", outcome_name(r.outcome)},
                           {"height_m", r.height_m},
                           {"elevation_deg", r.elevation_deg},
                           {"bending_arcsec", r.bending_arcsec},
                           {"optical_path_m", r.optical_path_m}});
  return out.dump(1) + "\n";
}

/// The view as `trace SCENE` draws it, with the rays asked for, at 200 steps to the longest distance, as its fan.
std::string drawing(TraceRequest request, const AirSection &air, const std::shared_ptr<Device> &device) {
  const double longest_m = *std::max_element(request.distances_m.begin(), request.distances_m.end());
  constexpr int steps = 200;
  request.distances_m.clear();
  for (int i = 0; i <= steps; ++i) request.distances_m.push_back(longest_m * i / steps);
  const Plot rays = ray_plot(trace_table(air, request, device), request, air.at(0));
  ViewRequest view;
  view.height_m = request.height_m, view.wavelengths_nm = request.wavelengths_nm, view.flat = request.flat;
  view.method = request.method, view.section = request.section, view.azimuth_rad = request.azimuth_rad;
  return view_sheet(diagnose_view(air, view, device), rays);
}

/// The rays of the contract: all four flags, or none and a view.
bool asks_for_rays(const Arguments &a) {
  if (!a.has("--altitudes")) return false;
  std::vector<Diagnostic> missing;
  for (const auto &[flag, value] : {std::pair{"--height", "M"}, {"--wavelengths", "LIST"}, {"--distances", "LIST"}})
    if (!a.has(flag))
      missing.push_back({a.end_place(), std::string("missing ") + flag + " " + value + " beside --altitudes"});
  if (!missing.empty()) throw InputError(std::move(missing));
  for (const char *flag : {"--target-distance", "--target-height", "--units", "--set"})
    if (a.has(flag)) a.fail(flag, "this is about a view: expected no --altitudes");
  return true;
}

int run(const Arguments &a) {
  if (!asks_for_rays(a)) return trace_view(a);
  const AirSection air(load_profile(a.positional()[0], ".", a.positional_place(0)));
  const TraceRequest request = request_from(a, air.spec());
  const bool json = a.choice("--format", {"csv", "json"}, a.has("--json") ? "json" : "csv") == "json";
  const bool plot = a.has("--plot");
  const std::string svg = plot ? a.file("--plot", ".svg") : "";
  if (plot && *std::max_element(request.distances_m.begin(), request.distances_m.end()) <= 0)
    a.fail("--plot", "nothing to draw: expected a distance above 0 in --distances");
  const std::shared_ptr<Device> device = open_device(device_options(a));
  const std::vector<TraceRow> rows = trace_table(air, request, device);
  if (plot) write_file_atomically(svg, drawing(request, air, device));
  emit(a, json ? as_json(rows, request, air) : as_csv(rows, request, air));
  return 0;
}

}  // namespace

Command trace_command() {
  return {
      with_common(
          {"trace",
           "SCENE|PROFILE",
           "What a view shows: mirages, horizon, what is hidden; with --altitudes where rays are at distances.",
           {{"--height", "", "M", "eye above the surface [m]; of a PROFILE"},
            {"--altitudes", "", "LIST", "apparent altitudes [deg]: a,b,c or FROM:TO:STEP; needs the two below"},
            {"--wavelengths", "", "LIST", "vacuum wavelengths [nm] (a view: 550)"},
            {"--distances", "", "LIST", "distances along the surface [m] (a view: the last one ends its fan of rays)"},
            {"--target-distance", "", "D", "what of a target is seen: 1200, 1.2km, 4000ft, 0.75mi, 0.65nmi"},
            {"--target-height", "", "H", "its height above the surface, likewise"},
            {"--units", "", "U", "m (default) | ft: of the text printed"},
            {"--set", "-D", "KEY=VALUE", "override any key of a SCENE, repeatable", false, true},
            {"--surface", "", "S", "sphere (default) | flat"},
            {"--precision", "", "P", "float | double (default)"},
            {"--method", "", "M", "auto | cells: layers in closed form | rk | richardson | section: as if it varied"},
            {"--azimuth", "", "DEG", "where the eye looks, from north (the profile's azimuth_deg; else from the path)"},
            {"--tolerance", "", "ARCSEC", "local accuracy of direction"},
            {"--plot", "", "FILE.svg",
             "draw the air with its ducts, the rays, the transfer curve and how often each altitude is seen"},
            {"--format", "", "F", "rows: csv (default) | json; a view: text (default) | json"},
            {"--output", "-o", "FILE", "write to a file"}}}),
      run};
}

}  // namespace greenray::cli
