// greenray render and check: a scene to EXR, PNG and JSON, or only what would be done.
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/commands.hpp"
#include "cli/observe.hpp"
#include "cli/progress.hpp"
#include "cli/render_command.hpp"
#include "cli/room_command.hpp"
#include "image/exr.hpp"
#include "render/report.hpp"
#include "report/sky_report.hpp"
#include "scene/scene_file.hpp"
#include "support/angle.hpp"
#include "support/atomic_file.hpp"
#include "support/version.hpp"

namespace greenray::cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

std::vector<int> integers(const Arguments &a, const std::string &flag, char separator, std::size_t count,
                          const std::string &expected) {
  std::vector<int> values;
  std::istringstream words(a.text(flag));
  for (std::string word; std::getline(words, word, separator);) {
    if (word.empty() || word.size() > 6 || word.find_first_not_of("0123456789") != std::string::npos)
      a.fail(flag, expected);
    values.push_back(std::stoi(word));
  }
  if (values.size() != count) a.fail(flag, expected);
  return values;
}

RenderOptions options_from(const Arguments &a) {
  RenderOptions options;
  options.seed = static_cast<std::uint64_t>(a.optional_number("--seed", 0, 9007199254740992.0, "").value_or(1));
  options.straight = a.has("--straight");
  options.quick = a.has("--quick");
  if (const auto spp = a.optional_number("--spp", 1, 1 << 20, "samples a pixel")) options.spp = static_cast<int>(*spp);
  options.error_pct = a.optional_number("--error", 1e-4, 100, "percent");
  options.minutes = a.optional_number("--minutes", 1e-3, 1e5, "minutes");
  if (a.has("--size")) {
    const auto n = integers(a, "--size", 'x', 2, "expected WxH in pixels, such as 1200x900");
    if (n[0] < 1 || n[1] < 1 || n[0] > 16384 || n[1] > 16384) a.fail("--size", "expected 1x1 to 16384x16384");
    options.size = {n[0], n[1]};
  }
  if (a.has("--crop")) {
    const auto n = integers(a, "--crop", ',', 4, "expected X0,Y0,X1,Y1 in pixels");
    options.crop = {n[0], n[1], n[2], n[3]};
    options.crop_place = a.place("--crop");
  }
  return options;
}

fs::path output_path(const Arguments &a, const Scene &scene) {
  fs::path path = a.has("--output") ? fs::path(a.file("--output", ".exr")) : fs::path(scene.output.image);
  if (path.empty()) path = fs::path("out") / (scene.name + ".exr");
  return path;
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  std::ostringstream text;
  text << std::put_time(&parts, "%Y-%m-%dT%H:%M:%SZ");
  return text.str();
}

ExrAttributes attributes_of(const Scene &scene, const RenderPlan &plan, const RenderOptions &options,
                            const Device &device) {
  std::string overrides;
  for (const std::string &o : scene.overrides) overrides += "-D " + o + "\n";
  return {{"greenray.version", std::string(version())},
          {"greenray.scene", scene.text},
          {"greenray.overrides", overrides},
          {"greenray.scene_hash", scene_hash(scene)},
          {"greenray.seed", std::to_string(options.seed)},
          {"greenray.device", device.info().name},
          {"greenray.time", utc_now()},
          {"greenray.straight", std::string(options.straight ? "yes" : "no")},
          {"greenray.exaggerate", scene.atmosphere.profile.exaggerate},
          {"greenray.fov_deg", scene.observer.fov_deg},
          {"greenray.pixel_arcsec", plan.pixel_arcsec}};
}

void print_header(const Scene &scene, const RenderPlan &plan, const Device &device) {
  const ProfileSpec &air = scene.atmosphere.profile;
  std::cout << "greenray " << version() << "   scene " << scene.name << "  \"" << scene.title << "\"\n"
            << "device   " << device.info().address() << " " << device.info().name << " (" << device.info().driver
            << "), " << device.info().compute_units << " units, budget " << std::fixed << std::setprecision(1)
            << static_cast<double>(device.budget_bytes()) / 1e9 << " GB\n"
            << "air      " << air.name;
  if (!air.inversions.empty()) std::cout << ", " << air.inversions.size() << " inversion(s)";
  if (!air.surface_layers.empty()) std::cout << ", " << air.surface_layers.size() << " surface layer(s)";
  if (!air.levels.empty()) std::cout << ", " << air.levels.size() << " levels";
  if (air.exaggerate != 1)
    std::cout << ", refractivity EXAGGERATED " << std::defaultfloat << air.exaggerate << " times";
  std::cout << "\nplan     " << plan.size[0] << "x" << plan.size[1] << ", " << plan.wavelengths_nm.size()
            << " wavelengths" << (plan.bent_nm.size() < plan.wavelengths_nm.size() ? " that bend as one" : "") << ", "
            << method_name(plan.method) << (plan.section ? " along the surface, " : ", ")
            << (plan.per_pixel ? "rays for every pixel, " : "one transfer table, ")
            << (plan.precision == Precision::double_ ? "double" : "float") << "\n"
            << std::flush;
}

void print_summary(const RenderReport &r, const RenderPlan &plan, double total) {
  std::cout << std::defaultfloat << std::setprecision(4) << "compile  kernels " << r.compile_seconds << " s\n"
            << "done     " << total << " s: table " << r.build_seconds << ", rays " << r.emit_seconds << " ("
            << static_cast<double>(r.trace.rays) / std::max(r.trace.device_seconds, 1e-9) / 1e6 << " Mray/s, "
            << static_cast<double>(r.trace.steps) / static_cast<double>(std::max<std::uint64_t>(r.trace.rays, 1))
            << " steps/ray), picture " << r.gather_seconds << "\n         " << r.spp << " samples a pixel, noise "
            << 100 * r.noise_rms << " %, errors: table " << r.table_arcsec << "\", solver " << r.solver_arcsec
            << "\", look-up " << r.lookup_arcsec << "\" (pixel " << plan.pixel_arcsec << "\")\n         rays:";
  for (int i = 1; i < static_cast<int>(r.trace.outcomes.size()); ++i)
    if (r.trace.outcomes[static_cast<std::size_t>(i)] > 0)
      std::cout << " " << outcome_name(i) << " " << r.trace.outcomes[static_cast<std::size_t>(i)];
  std::cout << "\n";
  if (r.sun_true_altitude_deg) {
    std::cout << "         Sun's centre at " << *r.sun_true_altitude_deg << " deg true";
    if (r.sun_apparent_altitude_deg) std::cout << ", seen at " << *r.sun_apparent_altitude_deg << " deg";
    if (r.horizon_altitude_deg) std::cout << "; horizon seen at " << *r.horizon_altitude_deg << " deg";
    std::cout << "\n";
  }
}

/// Is there room and right to write there? Found out before the work, not after.
void check_writable(const fs::path &path) {
  AtomicFile probe(path);  // creates the folder and a temporary, both as the result would be; removed again
  probe.write("x");
}

}  // namespace

int render_picture(const Arguments &a, Session &session) {
  if (const std::optional<int> done = render_room_scene(a, session)) return *done;
  const auto begin = Clock::now();
  const bool with_page = wants_report(a);
  RenderOptions options = options_from(a);
  const Scene scene = load_scene(a.positional()[0], a.all("--set"), a.positional_place(0));
  const RenderPlan plan = plan_render(scene, options);
  require_sun_in_sky(scene, options);
  const fs::path exr = output_path(a, scene);
  const std::shared_ptr<Device> device = session.device(a);
  check_writable(exr);

  const bool quiet = a.has("--quiet"), json = a.has("--json");
  Progress progress(quiet ? Progress::Style::quiet : json ? Progress::Style::json : Progress::Style::text);
  if (!quiet && !json) print_header(scene, plan, *device);
  for (const std::string &note : scene.notes) std::cerr << "note: " << note << "\n";
  options.progress = [&](const std::string &phase, double fraction, double noise) {
    progress.show(phase, fraction, noise);
  };
  options.cache = &session.sights();
  const Rendered rendered = render(scene, plan, options, device);
  progress.end();
  if (rendered.report.sun_optical_depth.value_or(0) > 14)
    std::cerr << "warning: haze and air dim the Sun by exp(-" << *rendered.report.sun_optical_depth
              << "): it cannot be seen; raise atmosphere.aerosol visibility_km\n";
  if (rendered.report.table_bound_arcsec > 1.01 * scene.tracing.table_arcsec)
    std::cerr << "warning: a layer of this air is too thin for the index table: its error may reach "
              << rendered.report.table_bound_arcsec << " arcsec for rays that graze it\n";

  AtomicFileSet files;
  AtomicFile &picture = files.add(exr);
  const ExrReport written =
      write_exr(picture, rendered.image, attributes_of(scene, plan, options, *device), {scene.output.spectral});
  if (written.not_finite_replaced > 0)
    std::cerr << "warning: " << written.not_finite_replaced << " values were not finite and are written as 0\n";
  const auto eye_begin = Clock::now();
  AtomicFile &png = files.add(fs::path(exr).replace_extension(".png"));
  const Observed observed = observe(scene.eye, scene.observer.fov_deg, plan.size[0], rendered.image, png);
  const double eye_seconds = seconds_since(eye_begin);
  nlohmann::json report =
      report_json(scene, plan, options, rendered.report, *device, observed.camera, {eye_seconds, seconds_since(begin)});
  if (!observed.eye.is_null()) {
    report.erase("camera");
    report["eye"] = observed.eye;
  }
  report["key"] = picture_key(a);
  if (with_page) {
    png.seal();
    const auto report_begin = Clock::now();
    const std::string page = sky_report({scene, plan, options, rendered, read_png(png.temporary()),
                                         observed.eye.is_null() ? observed.camera.key_cd_m2 : 0, command_line(a)},
                                        report, device);
    report["seconds"]["report"] = seconds_since(report_begin);
    files.add(fs::path(exr).replace_extension(".html")).write(page);
  }
  files.add(fs::path(exr).replace_extension(".json")).write(report.dump(1) + "\n");
  if (stop_requested()) throw Interrupted();
  files.commit();

  if (json) std::cout << nlohmann::json{{"event", "done"}, {"report", report}}.dump() << "\n";
  if (!quiet && !json) {
    print_summary(rendered.report, plan, seconds_since(begin));
    std::cout << "wrote    " << exr.string() << "  .png  .json" << (with_page ? "  .html\n" : "\n");
  }
  return 0;
}

bool wants_report(const Arguments &a) { return a.choice("--report", {"on", "off"}, "on") == "on"; }

std::string command_line(const Arguments &a) {
  const auto quoted = [](const std::string &word) {
    const bool plain = !word.empty() && word.find_first_of(" \t\n'\"\\$`*?[]{}()<>|&;#~!") == std::string::npos;
    if (plain) return word;
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
  };
  std::string line = "greenray render " + quoted(a.positional()[0]);
  for (const Flag &flag : render_command().spec.flags) {
    if (!a.has(flag.name)) continue;
    if (flag.value.empty()) line += " " + flag.name;
    else
      for (const std::string &value : a.all(flag.name)) line += " " + flag.name + " " + quoted(value);
  }
  return line;
}

std::string picture_key(const Arguments &a) {
  std::string key = room_scene_hash(a).value_or("");
  if (key.empty()) key = scene_hash(load_scene(a.positional()[0], a.all("--set"), a.positional_place(0)));
  for (const char *flag :
       {"--spp", "--photons", "--error", "--minutes", "--seed", "--size", "--crop", "--quick", "--straight"})
    if (a.has(flag)) key += std::string(" ") + flag + (a.text(flag).empty() ? "" : "=" + a.text(flag));
  return key + " " + version();
}

namespace {

int check(const Arguments &a) {
  Session session;
  if (const std::optional<int> done = check_room_scene(a, session)) return *done;
  const RenderOptions options = options_from(a);
  const Scene scene = load_scene(a.positional()[0], a.all("--set"), a.positional_place(0));
  const RenderPlan plan = plan_render(scene, options);
  require_sun_in_sky(scene, options);
  if (a.has("--device")) (void)session.device(a);  // is there such a one?
  if (a.has("--json")) {
    nlohmann::json out{{"scene", scene.name}, {"scene_hash", scene_hash(scene)}, {"plan", plan_json(plan)}};
    std::cout << out.dump(1) << "\n";
    return 0;
  }
  std::cout << "scene    " << scene.name << "  \"" << scene.title << "\"  (" << scene_hash(scene) << ")\n"
            << "picture  " << plan.size[0] << "x" << plan.size[1] << ", " << plan.pixel_arcsec << "\" a pixel, "
            << plan.wavelengths_nm.size() << " wavelengths\n"
            << "look-up  " << plan.entries << " elevations " << plan.spacing_arcsec << "\" apart from "
            << plan.first_elevation_deg << " deg\n"
            << "memory   " << plan.device_bytes / 1000000 + 1 << " MB on the device, " << plan.host_bytes / 1000000 + 1
            << " MB on the host\n";
  print_choices(plan.choices);
  for (const std::string &what : plan.modelled) std::cout << "modelled " << what << "\n";
  for (const std::string &what : plan.left_out) std::cout << "left out " << what << "\n";
  return 0;
}

}  // namespace

std::vector<Flag> render_flags() {
  return {{"--output", "-o", "OUT.exr", "where to write; .png, .json and .html go beside it"},
          {"--set", "-D", "KEY=VALUE", "override any scene key, repeatable", false, true},
          {"--spp", "", "N", "samples a pixel"},
          {"--photons", "", "N", "rooms: photons in all"},
          {"--photon-map", "", "N", "rooms: N photons of the map as dots, in OUT.photons.png and .exr"},
          {"--error", "", "PCT", "stop when the noise (rooms: noise and bias) is below this percentage"},
          {"--minutes", "", "M", "stop after this time"},
          {"--resume", "", "", "rooms: go on from OUT.grck, or fail; the default when it is there and fits"},
          {"--no-resume", "", "", "rooms: start anew whatever OUT.grck holds"},
          {"--checkpoint", "", "S", "rooms: seconds between checkpoints (60)"},
          {"--seed", "", "N", "of the sample places; the same seed gives the same bits"},
          {"--quick", "", "", "quarter size"},
          {"--size", "", "WxH", "size in pixels"},
          {"--crop", "", "X0,Y0,X1,Y1", "only this part of the picture"},
          {"--straight", "", "", "no bending, for comparison"},
          {"--report", "", "W", "on | off: OUT.html, a page of its own about the picture (render: on, batch: off)"}};
}

Command render_command() {
  return {with_common(
              {"render", "SCENE", "One picture: EXR with spectra, PNG, JSON and a report in HTML.", render_flags()}),
          [](const Arguments &a) {
            Session session;
            return render_picture(a, session);
          }};
}

Command check_command() {
  return {with_common(
              {"check", "SCENE", "What would be modelled, what is left out and why; renders nothing.", render_flags()}),
          check};
}

}  // namespace greenray::cli
