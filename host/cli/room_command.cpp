#include "cli/room_command.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "atmosphere/profile_file.hpp"
#include "cli/observe.hpp"
#include "cli/progress.hpp"
#include "image/colour.hpp"
#include "image/develop.hpp"
#include "image/exr.hpp"
#include "render/report.hpp"
#include "render/room_checkpoint.hpp"
#include "render/room_choices.hpp"
#include "render/room_estimate.hpp"
#include "render/room_report.hpp"
#include "report/room_page.hpp"
#include "support/atomic_file.hpp"
#include "support/embedded.hpp"
#include "support/toml_reader.hpp"
#include "support/version.hpp"

namespace greenray::cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// The text of a room, under its file name; nothing if the name is no room.
std::optional<std::pair<std::string, std::string>> room_text(const std::string &name, const SourcePlace &place) {
  for (const std::string &file : {name, "scenes/" + name + ".toml"}) {
    std::optional<std::string> text = file_contents(file, max_toml_bytes, place);
    if (!text && file != name)
      if (const auto shipped = embedded_file(file)) text = std::string(*shipped);
    if (text) return is_room_text(file, *text) ? std::optional(std::make_pair(file, *text)) : std::nullopt;
  }
  return std::nullopt;
}

std::optional<std::array<int, 4>> crop_from(const Arguments &a) {
  if (!a.has("--crop")) return std::nullopt;
  std::array<int, 4> crop{};
  std::istringstream words(a.text("--crop"));
  char comma = ',';
  bool right = true;
  for (std::size_t i = 0; i < 4; ++i) right = right && (i == 0 || words >> comma) && comma == ',' && words >> crop[i];
  if (!right || words >> comma) a.fail("--crop", "expected X0,Y0,X1,Y1 in pixels");
  return crop;
}

void read_stopping(const Arguments &a, RoomOptions &o) {
  if (const auto spp = a.optional_number("--spp", 1, 1 << 16, "samples a pixel")) o.spp = static_cast<int>(*spp);
  if (const auto photons = a.optional_number("--photons", 1, 1e12, "photons"))
    o.photons = static_cast<std::int64_t>(*photons);
  o.error_pct = a.optional_number("--error", 1e-4, 100, "percent");
  o.minutes = a.optional_number("--minutes", 1e-3, 1e5, "minutes");
}

RoomOptions options_from(const Arguments &a, const RoomScene &scene) {
  RoomOptions o;
  o.seed = static_cast<std::uint32_t>(a.optional_number("--seed", 0, 4294967295.0, "").value_or(1));
  o.straight = a.has("--straight");
  o.size = scene.camera.resolution;
  if (a.has("--size")) {
    int w = 0, h = 0;
    char x = 0, rest = 0;
    std::istringstream words(a.text("--size"));
    if (!(words >> w >> x >> h) || words >> rest || x != 'x' || w < 1 || h < 1 || w > 16384 || h > 16384)
      a.fail("--size", "expected WxH in pixels, 1x1 to 16384x16384");
    o.size = {w, h};
  }
  if (a.has("--quick")) o.size = {std::max(1, o.size[0] / 4), std::max(1, o.size[1] / 4)};
  o.crop = crop_from(a);
  if (o.crop) o.crop_place = a.place("--crop");
  read_stopping(a, o);
  o.photon_map = scene.photon_map;
  if (const auto shown = a.optional_number("--photon-map", 0, 1e9, "photons")) o.photon_map = std::llround(*shown);
  if (a.has("--resume") && a.has("--no-resume")) a.fail("--no-resume", "expected one of --resume and --no-resume");
  o.resume = a.has("--resume")      ? RoomOptions::Resume::always
             : a.has("--no-resume") ? RoomOptions::Resume::never
                                    : RoomOptions::Resume::when_it_fits;
  o.checkpoint_seconds = a.optional_number("--checkpoint", 0, 1e6, "seconds").value_or(60);
  return o;
}

std::string stopping_words(const RoomOptions &options, const RoomPlan &plan) {
  std::ostringstream text;
  text << plan.samples * (plan.open ? 1 : plan.passes) << " spp" << (plan.open ? " a pass" : "") << ", ";
  if (!plan.open) text << plan.photons << " photons in " << plan.passes << " passes";
  else text << plan.photons_a_pass << " photons a pass";
  if (options.error_pct) text << ", until the error is " << *options.error_pct << " %";
  if (options.minutes) text << ", for " << *options.minutes << " minutes";
  return text.str();
}

ExrAttributes attributes_of(const RoomScene &scene, const RoomOptions &options, const Device &device) {
  return {{"greenray.version", std::string(version())},
          {"greenray.scene", scene.text},
          {"greenray.scene_hash", room_hash(scene)},
          {"greenray.seed", std::to_string(options.seed)},
          {"greenray.device", device.info().name},
          {"greenray.straight", std::string(options.straight ? "yes" : "no")},
          {"greenray.exaggerate", scene.air ? scene.air->exaggerate : 1.0},
          {"greenray.fov_deg", scene.camera.fov_deg}};
}

void print_header(const RoomScene &scene, const RoomOptions &options, const Device &device) {
  const RoomPlan plan = plan_room(scene, options);
  std::cout << "greenray " << version() << "   scene " << scene.name << "  \"" << scene.title << "\"\n"
            << "device   " << device.info().address() << " " << device.info().name << " (" << device.info().driver
            << ")\n"
            << "plan     " << plan.crop[2] - plan.crop[0] << "x" << plan.crop[3] - plan.crop[1] << ", "
            << stopping_words(options, plan) << ", " << scene.spectrum.samples << " wavelengths, "
            << scene.surfaces.triangles.size() << " triangles\n";
  if (scene.air && scene.air->exaggerate != 1)
    std::cout << "air      refractivity EXAGGERATED " << scene.air->exaggerate << " times\n";
  std::cout << std::flush;
}

void print_summary(const RoomReport &r, double total) {
  const PhotonTotals &p = r.photons;
  std::cout << std::setprecision(4) << "compile  kernels " << r.compile_seconds << " s\n"
            << "done     " << total << " s: photons " << r.emit_seconds << " ("
            << static_cast<double>(p.photons) / std::max(r.emit_seconds, 1e-9) / 1e6 << " M/s), map " << r.map_seconds
            << ", gather " << r.gather_seconds << " (edges " << r.cover_seconds << ")"
            << ", eye " << r.eye_seconds << "\n         stored " << p.stored[0] << " diffuse, " << p.stored[1]
            << " caustic, of " << p.photons << " photons in " << r.passes << " passes"
            << (r.resumed_at > 0 ? ", " + std::to_string(r.resumed_at) + " of them from a checkpoint" : "")
            << "\n         error " << 100 * r.error_rms << " % of the mean (noise " << 100 * r.noise_rms << " %, bias "
            << (r.bias_is_seen ? "" : "below ") << 100 * (r.bias_is_seen ? r.bias_rms : r.bias_below) << " %), "
            << 100 * r.error_of_rms << " % of the RMS; medium " << r.air_cells << " cells good to "
            << 1000 * r.table_error_m << " mm\n";
}

/// output.aovs says which channels go into the file; left out, all do.
void keep_channels(const std::vector<std::string> &aovs, SpectralImage &image) {
  if (aovs.empty()) return;
  std::erase_if(image.channels, [&](const auto &channel) {
    const std::string word = channel.first == "depth_m" ? "depth" : channel.first;
    return std::find(aovs.begin(), aovs.end(), word) == aovs.end();
  });
}

/// OUT.photons.exr and .png: one photon of median power is a dot a little brighter than middle grey.
Raster write_photon_map(const SpectralImage &map, const fs::path &exr, AtomicFileSet &files,
                        const ExrAttributes &words) {
  write_exr(files.add(fs::path(exr).replace_extension(".photons.exr")), map, words, {false});
  Raster pixels = develop_camera(rgb_from_spectral(map), {std::nullopt, 8, true}).pixels;
  write_png(files.add(fs::path(exr).replace_extension(".photons.png")), pixels);
  return pixels;
}

/// Picture, PNG and report, all or none.
void write_room(const Arguments &a, const RoomScene &scene, const RoomOptions &options, const Device &device,
                RoomPicture &picture, const fs::path &exr, Clock::time_point begin, nlohmann::json &report) {
  const auto develop_begin = Clock::now();
  AtomicFileSet files;
  AtomicFile &png = files.add(fs::path(exr).replace_extension(".png"));
  const Observed observed = observe(scene.eye, scene.camera.fov_deg, options.size[0], picture.image, png);
  const double develop_seconds = seconds_since(develop_begin);
  keep_channels(scene.aovs, picture.image);
  write_exr(files.add(exr), picture.image, attributes_of(scene, options, device), {scene.output.spectral});
  std::optional<Raster> photon_map;
  if (picture.photon_map)
    photon_map = write_photon_map(*picture.photon_map, exr, files, attributes_of(scene, options, device));
  report = room_report_json(scene, options, picture.report, device, develop_seconds, seconds_since(begin));
  report["plan"]["choices"] = choices_json(room_choices(scene, options));
  if (!observed.eye.is_null()) report["eye"] = observed.eye;
  report["key"] = picture_key(a);
  if (wants_report(a)) {
    png.seal();
    report["command"] = command_line(a);
    files.add(fs::path(exr).replace_extension(".html")).write(room_page(report, read_png(png.temporary()), photon_map));
  }
  files.add(fs::path(exr).replace_extension(".json")).write(report.dump(1) + "\n");
  stop_if_asked();
  files.commit();
}

}  // namespace

std::optional<std::string> room_scene_hash(const Arguments &a) {
  const auto text = room_text(a.positional()[0], a.positional_place(0));
  if (!text) return std::nullopt;
  const RoomScene scene = parse_room(text->first, text->second, a.all("--set"));
  std::string hash = room_hash(scene);
  for (const auto &[key, value] : scene.values)
    if (key.starts_with("eye.")) hash += " " + key + "=" + value;  // the picture for the eye, too
  return hash;
}

std::optional<int> render_room_scene(const Arguments &a, Session &session) {
  const auto begin = Clock::now();
  const auto text = room_text(a.positional()[0], a.positional_place(0));
  if (!text) return std::nullopt;
  const RoomScene scene = parse_room(text->first, text->second, a.all("--set"));
  RoomOptions options = options_from(a, scene);
  const bool with_page = wants_report(a);  // a wrong word is told before the work
  fs::path exr = a.has("--output") ? fs::path(a.file("--output", ".exr")) : fs::path(scene.output.image);
  if (exr.empty()) exr = fs::path("out") / (scene.name + ".exr");
  const std::shared_ptr<Device> device = session.device(a);
  { AtomicFile(exr).write("x"); }  // is there room and right to write there?
  options.checkpoint = fs::path(exr).replace_extension(".grck");
  for (const char *extension : {".exr", ".png", ".json", ".html", ".grck", ".photons.exr", ".photons.png"})
    remove_stale_temporaries(fs::path(exr).replace_extension(extension));
  const bool quiet = a.has("--quiet"), json = a.has("--json");
  Progress progress(quiet ? Progress::Style::quiet : json ? Progress::Style::json : Progress::Style::text);
  if (!quiet && !json) print_header(scene, options, *device);
  options.progress = [&](const std::string &phase, double fraction, double noise) {
    progress.show(phase, fraction, noise);
  };
  options.note = [](const std::string &words) { std::cerr << "note: " << words << "\n"; };
  RoomPicture picture = render_room(scene, options, device);
  progress.end();

  nlohmann::json report;
  try {
    write_room(a, scene, options, *device, picture, exr, begin, report);
  } catch (const RunError &error) {
    if (!fs::exists(options.checkpoint)) throw;
    throw Error(ExitCode::stopped_early,
                std::string(error.what()) + "; the checkpoint is kept in " + options.checkpoint.string());
  }
  remove_checkpoint(options.checkpoint);
  if (json) std::cout << nlohmann::json{{"event", "done"}, {"report", report}}.dump() << "\n";
  if (!quiet && !json) {
    print_summary(picture.report, seconds_since(begin));
    std::cout << "wrote    " << exr.string() << "  .png  .json" << (with_page ? "  .html" : "")
              << (picture.photon_map ? "  .photons.exr  .photons.png" : "") << "\n";
  }
  return 0;
}

void print_choices(const std::vector<PlanChoice> &choices) {
  for (const PlanChoice &c : choices) {
    std::cout << "chosen   " << c.what << ": " << c.chosen << " (" << c.why << ")";
    if (!c.cost_unit.empty()) std::cout << "; costs " << c.cost << " " << c.cost_unit;
    std::cout << "\n";
  }
}

namespace {

/// From a probe on the device; nothing where no device was asked for and there is none.
std::optional<RoomEstimate> cost_of(const RoomScene &scene, const RoomOptions &options, const Arguments &a,
                                    Session &session) {
  try {
    return estimate_room(scene, options, session.device(a));
  } catch (const DeviceError &) {
    if (a.has("--device")) throw;
    return std::nullopt;
  }
}

void print_cost(const std::optional<RoomEstimate> &cost) {
  if (!cost) {
    std::cout << "time     not known: there is no OpenCL device\n";
    return;
  }
  std::cout << std::setprecision(2) << "memory   " << cost->device_bytes / 1000000 + 1 << " MB on the device\n"
            << "time     about " << cost->seconds.value_or(cost->seconds_a_pass) << (cost->seconds ? " s" : " s a pass")
            << ", from a probe that took " << cost->probe_seconds << " s; kernels, once, " << cost->compile_seconds
            << " s\n"
            << std::setprecision(6);
}

}  // namespace

std::optional<int> check_room_scene(const Arguments &a, Session &session) {
  const auto text = room_text(a.positional()[0], a.positional_place(0));
  if (!text) return std::nullopt;
  const RoomScene scene = parse_room(text->first, text->second, a.all("--set"));
  const RoomOptions options = options_from(a, scene);
  const std::vector<PlanChoice> choices = room_choices(scene, options);
  nlohmann::json plan = room_plan_json(scene, options);
  plan["choices"] = choices_json(choices);
  const std::optional<RoomEstimate> cost = cost_of(scene, options, a, session);
  if (cost) {
    plan["device_bytes"] = cost->device_bytes;
    plan["seconds_estimated"] = cost->seconds ? nlohmann::json(*cost->seconds) : nlohmann::json();
    plan["seconds_a_pass_estimated"] = cost->seconds_a_pass;
  }
  if (a.has("--json")) {
    std::cout << nlohmann::json{{"scene", scene.name}, {"scene_hash", room_hash(scene)}, {"plan", plan}}.dump(1)
              << "\n";
    return 0;
  }
  std::cout << "scene    " << scene.name << "  \"" << scene.title << "\"  (" << room_hash(scene) << ")\n"
            << "picture  " << options.size[0] << "x" << options.size[1] << ", " << scene.spectrum.samples
            << " wavelengths\n"
            << "photons  " << stopping_words(options, plan_room(scene, options)) << "; " << scene.photons.gather
            << " an estimate; " << scene.surfaces.triangles.size() << " triangles\n";
  print_cost(cost);
  print_choices(choices);
  for (const auto &[key, words] : {std::pair{"modelled", "modelled "}, {"left_out", "left out "}})
    for (const std::string what : plan.at(key)) std::cout << words << what << "\n";
  return 0;
}

}  // namespace greenray::cli
