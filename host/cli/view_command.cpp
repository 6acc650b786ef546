#include "cli/view_command.hpp"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "atmosphere/profile_file.hpp"
#include "render/solver_choice.hpp"
#include "render/sun_place.hpp"
#include "report/view_json.hpp"
#include "report/view_plots.hpp"
#include "scene/room_scene.hpp"
#include "scene/scene_file.hpp"
#include "support/angle.hpp"
#include "support/atomic_file.hpp"
#include "support/embedded.hpp"
#include "support/toml_reader.hpp"
#include "support/version.hpp"

namespace greenray::cli {
namespace {

namespace fs = std::filesystem;

/// Whether the text's own version key makes it a scene; other texts are profiles.
bool is_scene_text(const std::string &text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == std::string::npos || line[first] == '#') continue;
    if (line[first] == '[') return false;
    if (line.compare(first, 8, "greenray") == 0 && line.find_first_of(" \t=", first) == first + 8) return true;
  }
  return false;
}

/// A file says what it is; a shipped name that both have is the profile's where an eye's height is given.
bool names_scene(const Arguments &a) {
  const std::string &name = a.positional()[0];
  if (fs::exists(name)) {
    const auto text = file_contents(name, max_toml_bytes, a.positional_place(0));
    return text && is_scene_text(*text);
  }
  const bool scene = embedded_file("scenes/" + name + ".toml").has_value();
  const bool profile = embedded_file("profiles/" + name + ".toml").has_value();
  return scene && !(profile && a.has("--height"));
}

struct View {
  AirSection air;
  ViewRequest request;
  std::string scene;  // "" for a profile
};

void take_solver(const Arguments &a, const AirSection &air, ViewRequest &request) {
  const SolverChoice choice = choose_solver(
      air.spec(), a.choice("--method", {"auto", "cells", "rk", "richardson", "section"}, "auto"), a.place("--method"));
  request.method = choice.method, request.section = choice.section;
}

View view_of_scene(const Arguments &a) {
  for (const char *flag : {"--height", "--surface", "--azimuth"})
    if (a.has(flag)) a.fail(flag, "a scene has its own; use -D KEY=VALUE of the scene, or name a profile");
  const std::string &name = a.positional()[0];
  const auto text = fs::exists(name) ? file_contents(name, max_toml_bytes, a.positional_place(0))
                                     : std::optional(std::string(*embedded_file("scenes/" + name + ".toml")));
  if (text && is_room_text(name, *text))
    throw InputError(a.positional_place(0), "'" + name + "' is a room: expected a scene of the sky, or a profile");
  const Scene scene = load_scene(name, a.all("--set"), a.positional_place(0));
  View view{AirSection(spec_for(scene, {})), {}, scene.name};
  view.request.height_m = scene.observer.height_m;
  view.request.flat = scene.atmosphere.surface == Surface::flat;
  view.request.azimuth_rad = azimuth_from_path_rad(scene);
  return view;
}

View view_of_profile(const Arguments &a) {
  if (!a.has("--height")) throw InputError(a.end_place(), "missing --height M: of the eye above a profile");
  if (a.has("--set")) a.fail("--set", "a profile has no scene keys: expected a scene");
  View view{AirSection(load_profile(a.positional()[0], ".", a.positional_place(0))), {}, ""};
  view.request.height_m = a.number("--height", 0, 1e7, "m above the surface");
  view.request.flat = a.choice("--surface", {"sphere", "flat"}, "sphere") == "flat";
  view.request.azimuth_rad = azimuth_from_path_rad(a, view.air.spec());
  return view;
}

/// Lengths in the unit asked for.
struct Lengths {
  bool feet = false;
  std::string operator()(double m, int digits_ = 4) const {
    if (!std::isfinite(m)) return "beyond reach";
    if (feet) return plain_number(m / 0.3048, digits_) + " ft";
    return plain_number(m, digits_) + " m";
  }
  std::string far(double m) const {
    if (feet) return plain_number(m / 1609.344, 4) + " mi";
    return plain_number(m / 1000, 4) + " km";
  }
};

std::string deg(double value) {
  if (!std::isfinite(value)) return value < 0 ? "however low" : "-";
  std::ostringstream text;
  text << std::fixed << std::setprecision(4) << value;
  return text.str();
}

std::string mirages_text(const Mirages &m) {
  std::ostringstream out;
  out << "curve    " << m.branches.size() << (m.branches.size() == 1 ? " branch, " : " branches, ") << m.folds.size()
      << (m.folds.size() == 1 ? " fold, at most " : " folds, at most ") << m.most_images
      << (m.most_images == 1 ? " image" : " images") << " of one point, at " << plain_number(m.wavelength_nm, 5)
      << " nm\n";
  for (const FateBand &f : m.fates)
    out << "strip    " << deg(f.low_deg) << " to " << deg(f.high_deg) << " deg seen: "
        << (f.outcome == f64::RAY_SPACE     ? "sky"
            : f.outcome == f64::RAY_TRAPPED ? "held in a duct"
                                            : outcome_name(f.outcome))
        << "\n";
  for (const Branch &b : m.branches)
    out << "branch " << b.number << (b.number < 10 ? " " : "") << deg(b.low_deg) << " to " << deg(b.high_deg)
        << " deg seen, true " << deg(b.true_at_low_deg) << " to " << deg(b.true_at_high_deg) << ", "
        << (b.erect ? "erect" : "upside down") << "; from " << branch_end_name(b.low_end) << " to "
        << branch_end_name(b.high_end) << "\n";
  for (const Fold &f : m.folds)
    out << "fold " << f.number << (f.number < 10 ? "   " : "  ") << "seen " << deg(f.apparent_altitude_deg)
        << " deg, true " << deg(f.true_altitude_deg) << " deg, a " << (f.highest ? "maximum" : "minimum") << "\n";
  for (const ImageCount &c : m.counts)
    out << "images   " << c.images << " of true altitudes "
        << (std::isfinite(c.low_true_deg) ? deg(c.low_true_deg) : "however low") << " to " << deg(c.high_true_deg)
        << " deg\n";
  return out.str();
}

std::string sight_text(const SightLine &s, const Lengths &length) {
  std::ostringstream out;
  out << "target   " << length(s.target_height_m) << " high at " << length.far(s.distance_m) << ": hidden up to "
      << length(s.hidden_m) << " (without air " << length(s.hidden_straight_m) << ", with k = 0.13 "
      << length(s.hidden_k013_m) << "), " << length(s.visible_m()) << " in sight\n";
  const auto images = [&](const char *what, const std::vector<SightImage> &all) {
    for (const SightImage &i : all)
      out << "         " << what << " seen at " << deg(i.apparent_altitude_deg) << " deg"
          << (i.erect ? "" : ", upside down") << ": refraction " << plain_number(i.refraction_arcsec)
          << "\", k = " << plain_number(i.k_of_refraction) << " (mean along the ray " << plain_number(i.k_of_path)
          << ")\n";
  };
  images("its top", s.top);
  images("its lowest visible point", s.base);
  if (s.top.empty()) out << "         nothing of it is seen\n";
  return out.str();
}

std::string as_text(const ViewDiagnosis &v, const std::string &scene, const Lengths &length) {
  std::ostringstream out;
  out << "greenray " << version() << "   "
      << (scene.empty() ? "profile " + v.profile : "scene " + scene + ", air " + v.profile) << ", eye at "
      << length(v.height_m) << (v.flat ? ", flat surface" : "") << "\n";
  if (v.exaggerate != 1)
    out << "note     the refractivity is exaggerated " << plain_number(v.exaggerate, 6) << " times\n";
  for (const std::string &sentence : v.air.expect) out << "expect   " << sentence << "\n";
  out << "k        " << plain_number(v.k_at_eye) << " at the eye, " << plain_number(v.air.curvature_at_ground)
      << " at the ground (rays curve so many times as much as the Earth)\n";
  if (v.horizon_deg) {
    out << "horizon  seen at " << deg(*v.horizon_deg) << " deg";
    if (v.horizon_m) out << ", " << length.far(*v.horizon_m) << " away";
    if (v.geometric_horizon_deg)
      out << " (without air " << deg(*v.geometric_horizon_deg) << " deg, " << length.far(*v.geometric_horizon_m) << ")";
    out << "\n";
  }
  if (v.sight) out << sight_text(*v.sight, length);
  for (const Mirages &m : v.mirages) out << mirages_text(m);
  return out.str();
}

}  // namespace

double length_m(const Arguments &a, const std::string &flag, double low_m, double high_m) {
  static const std::pair<const char *, double> units[]{{"", 1},        {"m", 1},         {"km", 1000},
                                                       {"ft", 0.3048}, {"mi", 1609.344}, {"nmi", 1852}};
  const std::string text = a.text(flag);
  double value = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::string unit(end, text.data() + text.size());
  for (const auto &[name, metres] : units)
    if (failure == std::errc() && unit == name && value * metres >= low_m && value * metres <= high_m)
      return value * metres;
  a.fail(flag, "'" + text + "': expected a length from " + plain_number(low_m, 4) + " to " + plain_number(high_m, 4) +
                   " m, such as 1200, 1.2km, 4000ft, 0.75mi or 0.65nmi");
}

std::optional<Target> target_from(const Arguments &a) {
  const bool distance = a.has("--target-distance"), height = a.has("--target-height");
  if (!distance && !height) return std::nullopt;
  if (!distance || !height)
    a.fail(distance ? "--target-distance" : "--target-height",
           "expected --target-distance and --target-height together");
  return Target{length_m(a, "--target-distance", 1, 5e6), length_m(a, "--target-height", 0, 1e5)};
}

int trace_view(const Arguments &a) {
  const std::string format = a.choice("--format", {"csv", "json", "text"}, a.has("--json") ? "json" : "text");
  if (format == "csv")
    a.fail("--format", "a view has no rows: expected text or json (`greenray transfer` writes its curve as CSV)");
  const std::string svg = a.has("--plot") ? a.file("--plot", ".svg") : "";
  View view = names_scene(a) ? view_of_scene(a) : view_of_profile(a);
  take_solver(a, view.air, view.request);
  view.request.target = target_from(a);
  const Lengths length{a.choice("--units", {"m", "ft"}, "m") == "ft"};
  if (a.has("--wavelengths")) view.request.wavelengths_nm = a.list("--wavelengths", 200, 2000, "nm");
  if (a.has("--distances")) view.request.farthest_m = a.list("--distances", 1, 1e8, "m along the surface").back();
  const ViewDiagnosis found = diagnose_view(view.air, view.request, open_device(device_options(a)));
  stop_if_asked();
  if (!svg.empty()) write_file_atomically(svg, view_sheet(found));
  if (format == "text") {
    emit(a, as_text(found, view.scene, length));
    return 0;
  }
  nlohmann::json out = view_json(found);
  out["version"] = version();
  out["scene"] = view.scene.empty() ? nlohmann::json() : nlohmann::json(view.scene);
  emit(a, out.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  return 0;
}

}  // namespace greenray::cli
