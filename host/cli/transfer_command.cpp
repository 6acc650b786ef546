// greenray transfer: what every line of sight does, as a table that places its own rows; and where things are seen.
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "atmosphere/profile_file.hpp"
#include "cli/commands.hpp"
#include "render/renderer.hpp"
#include "render/solver_choice.hpp"
#include "render/transfer_curve.hpp"
#include "support/angle.hpp"
#include "support/version.hpp"

namespace greenray::cli {
namespace {

TransferCurve traced_curve(const Arguments &a) {
  SkyRayOptions options;
  options.height_m = a.number("--height", 0, 1e7, "m above the surface");
  options.precision = precision_of(a, Precision::double_);
  const double low_deg = a.optional_number("--from", -90, 90, "degrees").value_or(-2);
  const double high_deg = a.optional_number("--to", -90, 90, "degrees").value_or(10);
  if (!(low_deg < high_deg)) a.fail("--to", "expected an altitude above that of --from");
  const std::vector<double> wavelengths = a.list("--wavelengths", 200, 2000, "nm");
  const double tolerance = a.optional_number("--tolerance", 1e-5, 3600, "arcsec").value_or(0.01);
  options.error_arcsec = std::max(tolerance / 10, 1e-6);
  const AirSection air(load_profile(a.positional()[0], ".", a.positional_place(0)));
  const SolverChoice choice = choose_solver(
      air.spec(), a.choice("--method", {"auto", "rk", "richardson", "cells", "section"}, "auto"), a.place("--method"));
  options.method = choice.method;
  options.azimuth_rad = azimuth_from_path_rad(a, air.spec());
  options.step_rad = std::clamp(from_arcsec(tolerance / 20), 1e-12, 1e-6);
  options.max_steps = 1000000;
  const Profile profile = air.at(0);
  const std::shared_ptr<Device> device = open_device(device_options(a));
  SkyRays rays =
      choice.section ? SkyRays(air, wavelengths, options, device) : SkyRays(profile, wavelengths, options, device);
  TransferCurve curve = trace_transfer_curve(rays, to_rad(low_deg), to_rad(high_deg), tolerance);
  curve.profile = profile.spec().name;
  curve.zenith_column_kg_m2 = profile.zenith_column_kg_m2(options.height_m);
  return curve;
}

/// From a profile, or read back from a file.
TransferCurve curve_from(const Arguments &a) {
  const bool file = a.has("--table");
  if (file == !a.positional().empty())
    throw InputError({"command line", 1, 1}, "transfer: expected either a PROFILE or --table FILE.csv");
  if (file) {
    for (const char *flag :
         {"--height", "--from", "--to", "--wavelengths", "--tolerance", "--precision", "--method", "--azimuth"})
      if (a.has(flag)) a.fail(flag, "the table of --table has it already");
    if (!a.has("--images")) a.fail("--table", "expected --images LIST with it: true altitudes to look up");
    return read_transfer_curve(a.text("--table"));
  }
  for (const char *flag : {"--height", "--wavelengths"})
    if (!a.has(flag)) throw InputError({"command line", 1, 1}, std::string("transfer: expected ") + flag);
  return traced_curve(a);
}

nlohmann::json optional(bool known, double value) { return known ? nlohmann::json(value) : nlohmann::json(); }

std::string as_json(const TransferCurve &curve) {
  nlohmann::json out{{"version", version()},
                     {"profile", curve.profile},
                     {"height_m", curve.height_m},
                     {"interpolation_arcsec", curve.interpolation_arcsec},
                     {"rays_traced", curve.rays_traced},
                     {"rows", nlohmann::json::array()}};
  for (std::size_t e = 0; e < curve.elevation_rad.size(); ++e)
    for (std::size_t w = 0; w < curve.wavelength_nm.size(); ++w) {
      const Transfer &t = curve.at(e, w);
      const bool space = t.outcome == f64::RAY_SPACE, ended = space || t.outcome == f64::RAY_GROUND;
      const bool massive = ended && curve.zenith_column_kg_m2 > 0;
      out["rows"].push_back({{"apparent_altitude_deg", to_deg(curve.elevation_rad[e])},
                             {"wavelength_nm", curve.wavelength_nm[w]},
                             {"status", outcome_name(t.outcome)},
                             {"refraction_arcsec", optional(ended, to_arcsec(t.bending_rad))},
                             {"true_altitude_deg", optional(space, to_deg(t.true_altitude_rad))},
                             {"air_mass", optional(massive, massive ? t.column[0] / curve.zenith_column_kg_m2 : 0)},
                             {"min_height_m", t.min_height_m},
                             {"ground_distance_m", optional(ended, t.distance_m)},
                             {"joined_to_next", curve.joined(e, w)}});
    }
  return out.dump(1) + "\n";
}

/// Every image of every altitude asked for; one row without an image where there is none.
std::string images_text(const TransferCurve &curve, const std::vector<double> &altitudes_deg, bool json) {
  std::ostringstream csv;
  csv << "# greenray " << version() << " transfer, profile " << curve.profile << ", eye at " << digits(curve.height_m)
      << " m: where true altitudes are seen between " << digits(to_deg(curve.elevation_rad.front())) << " and "
      << digits(to_deg(curve.elevation_rad.back()))
      << " deg\ntrue_altitude_deg,wavelength_nm,images,image,apparent_altitude_deg,orientation,magnification\n";
  nlohmann::json rows = nlohmann::json::array();
  for (double altitude : altitudes_deg)
    for (std::size_t w = 0; w < curve.wavelength_nm.size(); ++w) {
      const std::vector<Image> images = images_of(curve, w, to_rad(altitude));
      nlohmann::json list = nlohmann::json::array();
      const std::string start =
          digits(altitude) + ',' + digits(curve.wavelength_nm[w]) + ',' + std::to_string(images.size()) + ',';
      if (images.empty()) csv << start << ",,,\n";
      for (std::size_t i = 0; i < images.size(); ++i) {
        const char *orientation = images[i].erect ? "erect" : "inverted";
        csv << start << i + 1 << ',' << digits(images[i].apparent_altitude_deg) << ',' << orientation << ','
            << digits(images[i].magnification) << '\n';
        list.push_back({{"apparent_altitude_deg", images[i].apparent_altitude_deg},
                        {"orientation", orientation},
                        {"magnification", images[i].magnification}});
      }
      rows.push_back({{"true_altitude_deg", altitude}, {"wavelength_nm", curve.wavelength_nm[w]}, {"images", list}});
    }
  const nlohmann::json out{
      {"version", version()}, {"profile", curve.profile}, {"height_m", curve.height_m}, {"rows", rows}};
  return json ? out.dump(1) + "\n" : csv.str();
}

int run(const Arguments &a) {
  const bool json = a.choice("--format", {"csv", "json"}, a.has("--json") ? "json" : "csv") == "json";
  std::vector<double> altitudes_deg;
  if (a.has("--images")) altitudes_deg = a.list("--images", -90, 90, "degrees");
  const TransferCurve curve = curve_from(a);
  stop_if_asked();
  emit(a, !altitudes_deg.empty() ? images_text(curve, altitudes_deg, json) : json ? as_json(curve) : as_csv(curve));
  return 0;
}

}  // namespace

Command transfer_command() {
  return {
      with_common(
          {"transfer",
           "[PROFILE]",
           "The transfer curve of an eye, as a table others can read; --images: where true altitudes are seen.",
           {{"--height", "", "M", "eye above the surface [m]"},
            {"--wavelengths", "", "LIST", "vacuum wavelengths [nm]"},
            {"--from", "", "DEG", "lowest apparent altitude (-2)"},
            {"--to", "", "DEG", "highest apparent altitude (10)"},
            {"--tolerance", "", "ARCSEC", "error of linear interpolation between rows (0.01)"},
            {"--precision", "", "P", "float | double (default)"},
            {"--method", "", "M", "auto | cells: layers in closed form | rk | richardson | section: as if it varied"},
            {"--azimuth", "", "DEG", "where the eye looks, from north (the profile's azimuth_deg; else from the path)"},
            {"--images", "", "LIST", "true altitudes [deg]: all apparent altitudes of each instead of the table"},
            {"--table", "", "FILE.csv", "a table written before, instead of PROFILE"},
            {"--format", "", "F", "csv (default) | json"},
            {"--output", "-o", "FILE", "write to a file"}}}),
      run};
}

}  // namespace greenray::cli
