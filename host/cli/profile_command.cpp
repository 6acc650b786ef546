// greenray profile: reads, checks, plots and rewrites air, and says what it does to light.
#include <algorithm>
#include <charconv>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "atmosphere/diagnosis.hpp"
#include "atmosphere/profile_file.hpp"
#include "atmosphere/surface_blend.hpp"
#include "cli/air_plot.hpp"
#include "cli/commands.hpp"
#include "support/angle.hpp"
#include "support/atomic_file.hpp"
#include "support/version.hpp"

namespace greenray::cli {
namespace {

constexpr double highest_m = 120000;

struct Request {
  std::vector<double> heights_m, wavelengths_nm;  // both empty: no table
  std::optional<double> eye_height_m;
  std::optional<SurfaceBlend> surface;
  bool json = false;
};

std::string trimmed(const std::string &text) {
  const auto first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// "water_C=14.2, air_C=18.6, top_m=40"
SurfaceBlend surface_blend(const Arguments &a) {
  const std::string flag = "--surface-layer",
                    form = "expected \"water_C=14.2, air_C=18.6, top_m=40\" (air_C may be left out)";
  const std::vector<std::string> names{"water_C", "air_C", "top_m"};
  std::vector<std::optional<double>> values(names.size());
  std::istringstream parts(a.text(flag));
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t equals = part.find('=');
    const std::string name = trimmed(part.substr(0, equals));
    const auto known = std::find(names.begin(), names.end(), name);
    if (known == names.end()) a.fail(flag, "unknown key '" + name + "'" + did_you_mean(name, names) + ": " + form);
    const std::string text = equals == std::string::npos ? "" : trimmed(part.substr(equals + 1));
    double value = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || status != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
      a.fail(flag, name + " '" + text + "' is not a number: " + form);
    std::optional<double> &slot = values[static_cast<std::size_t>(known - names.begin())];
    if (slot) a.fail(flag, name + " is given twice: " + form);
    slot = value;
  }
  if (!values[0] || !values[2]) a.fail(flag, std::string(values[0] ? "top_m" : "water_C") + " is missing: " + form);
  constexpr double ice_point_K = 273.15;
  return {*values[0] + ice_point_K, values[1] ? std::optional(*values[1] + ice_point_K) : std::nullopt, *values[2]};
}

Request request_from(const Arguments &a) {
  Request request;
  const bool heights = a.has("--heights"), wavelengths = a.has("--wavelengths");
  const bool table_optional = a.has("--output") || a.has("--plot");
  std::vector<Diagnostic> wrong;
  if (!heights && (wavelengths || !table_optional) && !(wavelengths && a.has("--plot")))
    wrong.push_back({a.place("--heights"),
                     "missing --heights LIST: heights above the surface [m] (not needed with only --plot or -o)"});
  if (!wavelengths && (heights || !table_optional))
    wrong.push_back({a.place("--wavelengths"),
                     "missing --wavelengths LIST: vacuum wavelengths [nm] (not needed with only --plot or -o)"});
  if (!wrong.empty()) throw InputError(wrong);
  if (heights) request.heights_m = a.list("--heights", 0, highest_m, "m above the surface");
  if (wavelengths) request.wavelengths_nm = a.list("--wavelengths", 200, 2000, "nm");
  request.eye_height_m = a.optional_number("--eye-height", 0, 1e7, "m above the surface");
  if (a.has("--surface-layer")) request.surface = surface_blend(a);
  request.json = a.choice("--format", {"csv", "json"}, a.has("--json") ? "json" : "csv") == "json";
  return request;
}

ProfileSpec load(const Arguments &a, const Request &request) {
  const SoundingChoice choice{a.text("--station"), a.text("--when")};
  ProfileSpec spec = load_profile(a.positional()[0], ".", a.positional_place(0), choice);
  if (request.surface) blend_surface(spec, *request.surface, a.place("--surface-layer"));
  return spec;
}

std::string index_name(const ProfileSpec &spec) {
  for (const auto &[word, model] : index_model_words())
    if (model == spec.index) return word;
  return "";
}

std::string comment(std::string text) {
  for (char &c : text)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return "# " + text + "\n";
}

std::string range(double bottom_m, double top_m) {
  return plain_number(bottom_m, 5) + " to " + plain_number(top_m, 5) + " m";
}

/// Everything but the rows, as comment lines.
std::string header(const Profile &profile, const Diagnosis &diagnosis) {
  const ProfileSpec &spec = profile.spec();
  std::string text =
      comment(std::string("greenray ") + version() + " profile " + spec.name + ", index " + index_name(spec) +
              (profile.is_air() ? "" : " (dispersion only: refractivity given at 550 nm)"));
  if (spec.exaggerate != 1) text += comment("the refractivity is exaggerated " + digits(spec.exaggerate) + " times");
  for (const std::string &note : spec.notes) text += comment("note: " + note);
  text += comment("ray curvature k = " + plain_number(diagnosis.curvature_at_ground) +
                  " at the ground (1 follows the Earth)");
  for (const Duct &d : diagnosis.ducts)
    text += comment("duct: " + range(d.bottom_m, d.top_m) + ", trapping layer from " +
                    plain_number(d.trapping_bottom_m, 5) + " m, holds rays within " +
                    plain_angle(to_rad(d.widest_trapped_deg)) + " of level");
  for (const Inversion &v : diagnosis.inversions)
    text += comment("inversion: " + range(v.bottom_m, v.top_m) + ", " + plain_number(v.rise_K) + " K, at most " +
                    plain_number(v.steepest_K_m) + " K/m");
  for (const SuperadiabaticLayer &s : diagnosis.superadiabatic)
    text += comment("superadiabatic: " + range(s.bottom_m, s.top_m) +
                    (profile.is_air() ? ", " + plain_number(s.fall_K) + " K warmer below" : ""));
  for (const std::string &sentence : diagnosis.expect) text += comment("expect: " + sentence);
  return text;
}

std::string as_csv(const Profile &profile, const Diagnosis &diagnosis, const Request &request) {
  std::ostringstream out;
  out << header(profile, diagnosis);
  if (request.heights_m.empty()) return out.str();
  out << "height_m,temperature_K,pressure_Pa,density_kg_m3,wavelength_nm,refractivity,refractivity_gradient_per_m\n";
  for (const double h : request.heights_m) {
    std::string air = ",,";
    if (profile.is_air()) {
      const AirState state = profile.air(h);
      air = digits(state.temperature_K.value) + "," + digits(state.pressure_Pa.value) + "," +
            digits(profile.density_kg_m3(h));
    }
    for (const double wavelength_nm : request.wavelengths_nm) {
      const Dual refractivity = profile.refractivity(h, wavelength_nm);
      out << digits(h) << ',' << air << ',' << digits(wavelength_nm) << ',' << digits(refractivity.value) << ','
          << digits(refractivity.slope) << '\n';
    }
  }
  return out.str();
}

nlohmann::json rows_json(const Profile &profile, const Request &request) {
  nlohmann::json rows = nlohmann::json::array();
  for (const double h : request.heights_m) {
    nlohmann::json air{
        {"height_m", h}, {"temperature_K", nullptr}, {"pressure_Pa", nullptr}, {"density_kg_m3", nullptr}};
    if (profile.is_air()) {
      const AirState state = profile.air(h);
      air["temperature_K"] = state.temperature_K.value;
      air["pressure_Pa"] = state.pressure_Pa.value;
      air["density_kg_m3"] = profile.density_kg_m3(h);
    }
    for (const double wavelength_nm : request.wavelengths_nm) {
      const Dual refractivity = profile.refractivity(h, wavelength_nm);
      nlohmann::json row = air;
      row["wavelength_nm"] = wavelength_nm;
      row["refractivity"] = refractivity.value;
      row["refractivity_gradient_per_m"] = refractivity.slope;
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

std::string as_json(const Profile &profile, const Diagnosis &diagnosis, const Request &request, const double *at_m) {
  using nlohmann::json;
  const ProfileSpec &spec = profile.spec();
  json out{{"version", version()},
           {"profile", spec.name},
           {"index", index_name(spec)},
           {"exaggerate", spec.exaggerate},
           {"notes", spec.notes},
           {"curvature_at_ground", diagnosis.curvature_at_ground},
           {"ducts", json::array()},
           {"inversions", json::array()},
           {"superadiabatic", json::array()},
           {"expect", diagnosis.expect}};
  if (at_m) out["at_m"] = *at_m;
  out["eye_height_m"] = request.eye_height_m ? json(*request.eye_height_m) : json();
  for (const Duct &d : diagnosis.ducts)
    out["ducts"].push_back({{"bottom_m", d.bottom_m},
                            {"trapping_bottom_m", d.trapping_bottom_m},
                            {"top_m", d.top_m},
                            {"index_drop", d.index_drop},
                            {"widest_trapped_deg", d.widest_trapped_deg}});
  for (const Inversion &v : diagnosis.inversions)
    out["inversions"].push_back({{"bottom_m", v.bottom_m},
                                 {"top_m", v.top_m},
                                 {"rise_K", v.rise_K},
                                 {"steepest_K_m", v.steepest_K_m},
                                 {"largest_curvature", v.largest_curvature}});
  for (const SuperadiabaticLayer &s : diagnosis.superadiabatic)
    out["superadiabatic"].push_back({{"bottom_m", s.bottom_m},
                                     {"top_m", s.top_m},
                                     {"fall_K", profile.is_air() ? json(s.fall_K) : json()},
                                     {"index_rise", s.index_rise}});
  out["rows"] = rows_json(profile, request);
  return out.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

/// Where along the surface this air stands, and whether that matters.
std::string places_text(const AirSection &section, double at_m) {
  const std::string where = "the air at x = " + digits(at_m) + " m along the surface";
  if (section.points_m().empty()) return comment(where + "; nothing varies with x: the solver for layers serves");
  return comment(where + "; it varies from " + digits(section.points_m().front()) + " to " +
                 digits(section.points_m().back()) + " m: the adaptive solver serves");
}

int run(const Arguments &a) {
  const Request request = request_from(a);
  const std::string toml = a.has("--output") ? a.file("--output", ".toml") : "";
  const std::string svg = a.has("--plot") ? a.file("--plot", ".svg") : "";
  const AirSection section(load(a, request));
  const ProfileSpec &spec = section.spec();
  if (a.has("--at") && !has_places(spec))
    a.fail("--at", "this air is the same everywhere along the surface: expected a profile with lists x_m or stations");
  const double at_m = a.optional_number("--at", -1e9, 1e9, "m along the surface").value_or(0);
  const Profile profile = section.at(at_m);
  const Diagnosis diagnosis = diagnose(profile, request.eye_height_m);
  const std::string places = has_places(spec) ? places_text(section, at_m) : "";
  const std::string text = request.json ? as_json(profile, diagnosis, request, has_places(spec) ? &at_m : nullptr)
                                        : places + as_csv(profile, diagnosis, request);
  AtomicFileSet files;
  if (!toml.empty()) files.add(toml).write(write_profile(spec));
  if (!svg.empty()) {
    const std::vector<double> shown =
        request.wavelengths_nm.empty() ? std::vector<double>{diagnosis_wavelength_nm} : request.wavelengths_nm;
    files.add(svg).write(draw_svg(air_plot(profile, diagnosis, shown, request.eye_height_m)));
  }
  files.commit();
  std::cout << text << std::flush;
  if (!std::cout) throw RunError("cannot write to standard output");
  return 0;
}

}  // namespace

Command profile_command() {
  return {
      with_common({"profile",
                   "PROFILE",
                   "Air by height: T, P, density, refractivity; its ducts and the mirages to expect; plot; import.",
                   {{"--heights", "", "LIST", "heights above the surface [m]: a,b,c or FROM:TO:STEP, 0 to 120000"},
                    {"--wavelengths", "", "LIST", "vacuum wavelengths [nm]; both lists may go with --plot or -o"},
                    {"--at", "", "X_M", "air that varies along the surface: over this place (0) [m]"},
                    {"--eye-height", "", "M", "tell the mirages to expect at this height [m]"},
                    {"--plot", "", "FILE.svg", "draw T, P, n-1 and d(n-1)/dh against height"},
                    {"--output", "-o", "FILE.toml", "write the air as a profile file"},
                    {"--station", "", "ID", "of a file of soundings: this station"},
                    {"--when", "", "TIME", "of a file of soundings: 2024-06-21T12, or #2 for the second"},
                    {"--surface-layer", "", "KEYS", "\"water_C=14.2, air_C=18.6, top_m=40\": what balloons cannot see"},
                    {"--format", "", "F", "csv (default) | json"}}}),
      run};
}

}  // namespace greenray::cli
