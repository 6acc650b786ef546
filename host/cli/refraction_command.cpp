// greenray refraction: apparent altitude -> refraction, true altitude, air mass, per wavelength.
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "atmosphere/profile_file.hpp"
#include "cli/commands.hpp"
#include "render/refraction.hpp"
#include "render/renderer.hpp"
#include "render/solver_choice.hpp"
#include "support/version.hpp"

namespace greenray::cli {
namespace {

const std::vector<std::string> methods{"auto", "rk", "richardson", "cells", "section"};

RefractionRequest request_from(const Arguments &a, const ProfileSpec &air) {
  RefractionRequest request;
  request.height_m = a.number("--height", 0, 1e7, "m above the surface");
  request.altitudes_deg = a.list("--altitudes", -90, 90, "degrees");
  request.wavelengths_nm = a.list("--wavelengths", 200, 2000, "nm");
  request.precision = precision_of(a, Precision::double_);
  const std::string method = a.choice("--method", methods, "auto");
  const SolverChoice choice = choose_solver(air, method, a.place("--method"));
  request.method = choice.method;
  request.section = choice.section;
  request.azimuth_rad = azimuth_from_path_rad(a, air);
  const bool single = request.precision == Precision::single_;
  request.tolerance_arcsec = a.optional_number("--tolerance", 1e-6, 3600, "arcsec")
                                 .value_or(single                   ? 0.01
                                           : method == "richardson" ? 1e-3
                                                                    : 1e-5);
  return request;
}

std::string cell(const std::optional<double> &value) { return value ? digits(*value) : ""; }

std::string as_csv(const RefractionTable &table, const RefractionRequest &request, const AirSection &profile) {
  std::ostringstream out;
  out << "# greenray " << version() << " refraction, profile " << profile.spec().name << ", eye at "
      << digits(request.height_m) << " m, " << (request.precision == Precision::double_ ? "double" : "float") << "\n"
      << "# estimated error " << table.error_arcsec << " arcsec (table of " << table.cells_per_row
      << " cells, solver and rounding), tolerance " << request.tolerance_arcsec << "\n";
  if (has_places(profile.spec())) out << "# solver: " << solver_words(profile.spec(), request.section) << "\n";
  if (table.measured_table_arcsec)
    out << "# measured error: table " << *table.measured_table_arcsec << " arcsec, solver "
        << *table.measured_solver_arcsec << " arcsec (over max(1, |dR/da|))\n";
  if (profile.spec().exaggerate != 1)
    out << "# the refractivity is exaggerated " << digits(profile.spec().exaggerate) << " times\n";
  out << "apparent_altitude_deg,wavelength_nm,status,refraction_arcsec,true_altitude_deg,air_mass,min_height_m,"
         "max_height_m,ground_distance_m,turning_points\n";
  for (const RefractionRow &r : table.rows)
    out << digits(r.apparent_altitude_deg) << ',' << digits(r.wavelength_nm) << ',' << outcome_name(r.outcome) << ','
        << cell(r.refraction_arcsec) << ',' << cell(r.true_altitude_deg) << ',' << cell(r.air_mass) << ','
        << digits(r.min_height_m) << ',' << digits(r.max_height_m) << ',' << cell(r.ground_distance_m) << ','
        << r.turning_points << '\n';
  return out.str();
}

nlohmann::json cell_json(const std::optional<double> &value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

std::string as_json(const RefractionTable &table, const RefractionRequest &request, const AirSection &profile) {
  nlohmann::json out;
  out["version"] = version();
  out["profile"] = profile.spec().name;
  out["height_m"] = request.height_m;
  out["precision"] = request.precision == Precision::double_ ? "double" : "float";
  out["exaggerate"] = profile.spec().exaggerate;
  out["tolerance_arcsec"] = request.tolerance_arcsec;
  out["estimated_error_arcsec"] = table.error_arcsec;
  out["cells"] = table.cells_per_row;
  out["table_arcsec"] = cell_json(table.measured_table_arcsec);
  out["solver_arcsec"] = cell_json(table.measured_solver_arcsec);
  out["solver"] = request.section ? "section" : "layers";
  out["rows"] = nlohmann::json::array();
  for (const RefractionRow &r : table.rows)
    out["rows"].push_back({{"apparent_altitude_deg", r.apparent_altitude_deg},
                           {"wavelength_nm", r.wavelength_nm},
                           {"status", outcome_name(r.outcome)},
                           {"refraction_arcsec", cell_json(r.refraction_arcsec)},
                           {"true_altitude_deg", cell_json(r.true_altitude_deg)},
                           {"air_mass", cell_json(r.air_mass)},
                           {"min_height_m", r.min_height_m},
                           {"max_height_m", r.max_height_m},
                           {"ground_distance_m", cell_json(r.ground_distance_m)},
                           {"turning_points", r.turning_points},
                           {"sideways_arcsec", r.sideways_arcsec},
                           {"error_arcsec", r.error_arcsec < 1e8 ? nlohmann::json(r.error_arcsec) : nlohmann::json()}});
  return out.dump(1) + "\n";
}

int run(const Arguments &a) {
  const AirSection profile(load_profile(a.positional()[0], ".", a.positional_place(0)));
  const RefractionRequest request = request_from(a, profile.spec());
  const std::string format = a.choice("--format", {"csv", "json"}, a.has("--json") ? "json" : "csv");
  const RefractionTable table = refraction_table(profile, request, open_device(device_options(a)));
  if (table.rows_over_tolerance > 0 && !a.has("--quiet"))
    std::cerr << "warning: " << table.rows_over_tolerance << " of " << table.rows.size()
              << " rows may be off by more than the tolerance (at most " << table.error_arcsec
              << " arcsec): " << (request.precision == Precision::double_ ? "" : "try --precision double, or ")
              << "expect it near folds\n";
  if (table.table_bound_arcsec > request.tolerance_arcsec && !a.has("--quiet"))
    std::cerr << "warning: a layer of this air is too thin for the index table: rays that graze it may be off by "
              << table.table_bound_arcsec << " arcsec, more than the tolerance\n";
  const std::string text = format == "json" ? as_json(table, request, profile) : as_csv(table, request, profile);
  stop_if_asked();
  emit(a, text);
  return 0;
}

}  // namespace

Command refraction_command() {
  return {
      with_common(
          {"refraction",
           "PROFILE",
           "Refraction of rays that reach the eye: table over apparent altitude and wavelength.",
           {{"--height", "", "M", "eye above the surface [m]", true},
            {"--altitudes", "", "LIST", "apparent altitudes [deg]: a,b,c or FROM:TO:STEP", true},
            {"--wavelengths", "", "LIST", "vacuum wavelengths [nm]", true},
            {"--precision", "", "P", "float | double (default)"},
            {"--method", "", "M", "auto | cells: layers in closed form | rk | richardson | section: as if it varied"},
            {"--azimuth", "", "DEG", "where the eye looks, from north (the profile's azimuth_deg; else from the path)"},
            {"--tolerance", "", "ARCSEC", "bound of the error of refraction_arcsec, table included"},
            {"--format", "", "F", "csv (default) | json"},
            {"--output", "-o", "FILE", "write to a file"}}}),
      run};
}

}  // namespace greenray::cli
