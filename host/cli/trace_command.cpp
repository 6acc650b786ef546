// greenray trace: where rays are after given distances along the surface.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "atmosphere/profile_file.hpp"
#include "cli/air_plot.hpp"
#include "cli/commands.hpp"
#include "render/refraction.hpp"
#include "render/solver_choice.hpp"
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

/// The rays again at 200 steps to the longest distance asked for, as a picture.
std::string drawing(TraceRequest request, const AirSection &air, const std::shared_ptr<Device> &device) {
  const double longest_m = *std::max_element(request.distances_m.begin(), request.distances_m.end());
  constexpr int steps = 200;
  request.distances_m.clear();
  for (int i = 0; i <= steps; ++i) request.distances_m.push_back(longest_m * i / steps);
  return draw_svg(ray_plot(trace_table(air, request, device), request, air.at(0)));
}

int run(const Arguments &a) {
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
           "PROFILE",
           "Rays from the eye: height, elevation, bending and optical path at distances along the surface.",
           {{"--height", "", "M", "eye above the surface [m]", true},
            {"--altitudes", "", "LIST", "apparent altitudes [deg]: a,b,c or FROM:TO:STEP", true},
            {"--wavelengths", "", "LIST", "vacuum wavelengths [nm]", true},
            {"--distances", "", "LIST", "distances along the surface [m]", true},
            {"--surface", "", "S", "sphere (default) | flat"},
            {"--precision", "", "P", "float | double (default)"},
            {"--method", "", "M", "auto | cells: layers in closed form | rk | richardson | section: as if it varied"},
            {"--azimuth", "", "DEG", "where the eye looks, from north (the profile's azimuth_deg; else from the path)"},
            {"--tolerance", "", "ARCSEC", "local accuracy of direction"},
            {"--plot", "", "FILE.svg", "draw the rays, height against distance"},
            {"--format", "", "F", "csv (default) | json"},
            {"--output", "-o", "FILE", "write to a file"}}}),
      run};
}

}  // namespace greenray::cli
