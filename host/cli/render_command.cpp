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
#include "cli/mpi.hpp"
#include "cli/observe.hpp"
#include "cli/progress.hpp"
#include "cli/render_command.hpp"
#include "cli/room_command.hpp"
#include "cli/share_words.hpp"
#include "image/exr.hpp"
#include "render/report.hpp"
#include "render/room_checkpoint.hpp"
#include "render/sky_run.hpp"
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
                            const std::string &device) {
  std::string overrides;
  for (const std::string &o : scene.overrides) overrides += "-D " + o + "\n";
  return {{"greenray.version", std::string(version())},
          {"greenray.scene", scene.text},
          {"greenray.overrides", overrides},
          {"greenray.scene_hash", scene_hash(scene)},
          {"greenray.seed", std::to_string(options.seed)},
          {"greenray.device", device},
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

/// A picture of the sky to be made: what the words of a command line say.
struct SkyJob {
  RenderOptions options;
  Scene scene;
  RenderPlan plan;
  fs::path exr;

  explicit SkyJob(const Arguments &a)
      : options(options_from(a)),
        scene(load_scene(a.positional()[0], a.all("--set"), a.positional_place(0))),
        plan(plan_render(scene, options)),
        exr(output_path(a, scene)) {
    (void)wants_report(a);  // a wrong word is told before the work
    require_sun_in_sky(scene, options);
  }
};

bool talks(const Arguments &a) { return !a.has("--quiet") && !a.has("--json"); }

Progress progress_of(const Arguments &a) {
  return Progress(a.has("--quiet")  ? Progress::Style::quiet
                  : a.has("--json") ? Progress::Style::json
                                    : Progress::Style::text);
}

/// Picture, PNG and report, all or none. numbers: of the picture, by what its camera did and the seconds it took.
/// device: for the page's own rays; null: no page.
void write_sky(const Arguments &a, const SkyJob &job, const Rendered &rendered, const std::string &device_name,
               const std::function<nlohmann::json(const CameraReport &, double)> &numbers,
               const std::shared_ptr<Device> &device) {
  AtomicFileSet files;
  AtomicFile &picture = files.add(job.exr);
  const ExrReport written =
      write_exr(picture, rendered.image, attributes_of(job.scene, job.plan, job.options, device_name),
                {job.scene.output.spectral});
  if (written.not_finite_replaced > 0)
    std::cerr << "warning: " << written.not_finite_replaced << " values were not finite and are written as 0\n";
  const auto eye_begin = Clock::now();
  AtomicFile &png = files.add(fs::path(job.exr).replace_extension(".png"));
  const Observed observed = observe(job.scene.eye, job.scene.observer.fov_deg, job.plan.size[0], rendered.image, png);
  nlohmann::json report = numbers(observed.camera, seconds_since(eye_begin));
  if (!observed.eye.is_null()) {
    report.erase("camera");
    report["eye"] = observed.eye;
  }
  report["key"] = picture_key(a);
  if (device) {
    png.seal();
    const auto report_begin = Clock::now();
    const std::string page = sky_report({job.scene, job.plan, job.options, rendered, read_png(png.temporary()),
                                         observed.eye.is_null() ? observed.camera.key_cd_m2 : 0, command_line(a)},
                                        report, device);
    report["seconds"]["report"] = seconds_since(report_begin);
    files.add(fs::path(job.exr).replace_extension(".html")).write(page);
  }
  files.add(fs::path(job.exr).replace_extension(".json")).write(report.dump(1) + "\n");
  if (stop_requested()) throw Interrupted();
  files.commit();
  if (a.has("--json")) std::cout << nlohmann::json{{"event", "done"}, {"report", report}}.dump() << "\n";
}

void warn_of(const Rendered &rendered, const Scene &scene) {
  if (rendered.report.sun_optical_depth.value_or(0) > 14)
    std::cerr << "warning: haze and air dim the Sun by exp(-" << *rendered.report.sun_optical_depth
              << "): it cannot be seen; raise atmosphere.aerosol visibility_km\n";
  if (rendered.report.table_bound_arcsec > 1.01 * scene.tracing.table_arcsec)
    std::cerr << "warning: a layer of this air is too thin for the index table: its error may reach "
              << rendered.report.table_bound_arcsec << " arcsec for rays that graze it\n";
}

SkyKeeping keeping_from(const Arguments &a, const SkyJob &job, const std::optional<PictureShare> &share) {
  SkyKeeping k;
  k.share = share;
  k.file = share ? part_path(job.exr, *share) : fs::path(job.exr).replace_extension(".grck");
  if (a.has("--resume") && a.has("--no-resume")) a.fail("--no-resume", "expected one of --resume and --no-resume");
  k.resume = a.has("--resume")      ? SkyKeeping::Resume::always
             : a.has("--no-resume") ? SkyKeeping::Resume::never
                                    : SkyKeeping::Resume::when_it_fits;
  if (const auto seconds = a.optional_number("--checkpoint", 0, 1e6, "seconds")) k.seconds = *seconds, k.not_before = 0;
  k.command = words_without_share(a);
  k.note = [](const std::string &words) { std::cerr << "note: " << words << "\n"; };
  return k;
}

/// On one device, on several by a thread each, or with the other processes of mpirun.
Rendered render_by_all(const SkyJob &job, const std::vector<std::shared_ptr<Device>> &devices, Ranks &workers) {
  RenderOptions options = job.options;
  options.ranks = &workers;
  if (workers.size() > 1 || devices.size() == 1) return render(job.scene, job.plan, options, devices.front());
  Rendered made;
  run_threads(static_cast<int>(devices.size()), [&](Ranks &ranks) {
    RenderOptions own = job.options;
    own.ranks = &ranks;
    if (!ranks.first()) own.cache = nullptr, own.progress = nullptr;
    Rendered part = render(job.scene, job.plan, own, devices[static_cast<std::size_t>(ranks.rank())]);
    if (ranks.first()) made = std::move(part);
  });
  return made;
}

struct SkyRender {
  std::optional<SkyJob> job;
  std::optional<PictureShare> share;
  std::vector<std::shared_ptr<Device>> devices;
};

/// Everything before the work, told by one worker if it is wrong.
SkyRender prepare(const Arguments &a, Session &session, Ranks &workers) {
  SkyRender r;
  workers.together([&] {
    r.job.emplace(a);
    r.share = share_from(a);
    r.devices = session.devices(a);
    if (r.share && (r.job->plan.error_pct || r.job->plan.minutes))
      a.fail("--shard", "expected a number of samples that each share knows: not an error or minutes, but --spp");
    if (workers.size() > 1) {
      if (r.share) a.fail("--shard", "expected one of --shard and mpirun");
      r.devices = {r.devices[static_cast<std::size_t>(worker_on_this_machine()) % r.devices.size()]};
    }
    if (r.share) r.devices.resize(1);
    if (workers.first()) check_writable(r.share ? part_path(r.job->exr, *r.share) : r.job->exr);
  });
  return r;
}

/// Rays that rows of other shares had of their own.
void add_rays(const TraceStats &more, nlohmann::json &numbers) {
  const auto add = [](nlohmann::json &to, std::uint64_t count) { to = to.get<std::uint64_t>() + count; };
  add(numbers.at("rays_launched"), more.rays);
  add(numbers.at("steps").at("accepted"), more.steps), add(numbers.at("steps").at("rejected"), more.rejected);
  for (int i = 1; i < static_cast<int>(more.outcomes.size()); ++i)
    add(numbers.at("outcomes").at(outcome_name(i)), more.outcomes[static_cast<std::size_t>(i)]);
  nlohmann::json &drift = numbers.at("bouguer_drift");
  drift = std::max(drift.get<double>(), more.bouguer_drift);
}

}  // namespace

int render_picture(const Arguments &a, Session &session) {
  if (const std::optional<int> done = render_room_scene(a, session)) return *done;
  const auto begin = Clock::now();
  Ranks &workers = all_workers();
  SkyRender r = prepare(a, session, workers);
  SkyJob &job = *r.job;
  const Device &device = *r.devices.front();
  const SkyKeeping keeping = keeping_from(a, job, r.share);
  job.options.keeping = &keeping;
  if (!workers.first()) {
    (void)render_by_all(job, r.devices, workers);
    return 0;
  }
  remove_stale_outputs(job.exr);
  remove_stale_temporaries(keeping.file);
  if (talks(a)) print_header(job.scene, job.plan, device);
  for (const std::string &note : job.scene.notes) std::cerr << "note: " << note << "\n";
  Progress progress = progress_of(a);
  job.options.progress = [&](const std::string &phase, double fraction, double noise) {
    progress.show(phase, fraction, noise);
  };
  job.options.cache = &session.sights();
  const auto numbers_of = [&](const RenderReport &report, const CameraReport &camera, double eye_seconds) {
    return report_json(job.scene, job.plan, job.options, report, device, camera, {eye_seconds, seconds_since(begin)});
  };
  job.options.part_report = [&](const RenderReport &report) { return numbers_of(report, {}, 0).dump(); };
  const Rendered rendered = render_by_all(job, r.devices, workers);
  progress.end();
  warn_of(rendered, job.scene);
  if (r.share) {
    tell_share(a, *r.share, keeping.file, rendered.report.resumed_rows);
    return 0;
  }
  const bool with_page = wants_report(a);
  const bool kept = fs::exists(keeping.file);
  try {
    write_sky(
        a, job, rendered, device.info().name,
        [&](const CameraReport &camera, double eye) { return numbers_of(rendered.report, camera, eye); },
        with_page ? r.devices.front() : nullptr);
  } catch (const RunError &error) {
    if (!kept) throw;
    throw Error(ExitCode::stopped_early,
                std::string(error.what()) + "; the checkpoint is kept in " + keeping.file.string());
  }
  if (kept) remove_checkpoint(keeping.file);
  if (talks(a)) {
    print_summary(rendered.report, job.plan, seconds_since(begin));
    std::cout << "wrote    " << job.exr.string() << "  .png  .json" << (with_page ? "  .html\n" : "\n");
  }
  return 0;
}

void merge_sky_parts(const Arguments &a, const std::vector<fs::path> &parts, Session &session) {
  const auto begin = Clock::now();
  const SkyJob job(a);
  check_writable(job.exr);
  remove_stale_outputs(job.exr);
  std::shared_ptr<Device> device;
  try {
    if (wants_report(a)) device = session.device(a);
  } catch (const DeviceError &none) {
    std::cerr << "note: without a page of its own, for there is no device: " << none.what() << "\n";
  }
  MergedSky merged = merge_sky(job.scene, job.plan, job.options, parts);
  nlohmann::json numbers = nlohmann::json::parse(merged.report_json);
  numbers["error"]["noise_rms"] = merged.noise_rms, numbers["samples_per_pixel"] = merged.spp;
  add_rays(merged.more_rays, numbers);
  numbers["seconds"]["workers"] = parts.size();
  Rendered rendered{std::move(merged.image), {}};
  const nlohmann::json &sun = numbers.at("sun").at("true_altitude_deg");
  if (sun.is_number()) rendered.report.sun_true_altitude_deg = sun.get<double>();
  rendered.report.trace.rays = numbers.at("rays_launched"),
  rendered.report.trace.steps = numbers.at("steps").at("accepted");
  rendered.report.trace.device_seconds = numbers.at("seconds").at("emit");
  write_sky(
      a, job, rendered, numbers.at("device").at("name"),
      [&](const CameraReport &camera, double eye) {
        numbers["camera"] = camera_json(camera);
        numbers["seconds"]["eye"] = eye, numbers["seconds"]["total"] = seconds_since(begin);
        return numbers;
      },
      device);
  if (talks(a))
    std::cout << "wrote    " << job.exr.string() << "  .png  .json" << (device ? "  .html" : "") << ", of "
              << parts.size() << " shares\n";
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
          {"--resume", "", "", "go on from OUT.grck, or fail; the default when it is there and fits"},
          {"--no-resume", "", "", "start anew whatever OUT.grck holds"},
          {"--checkpoint", "", "S", "seconds between checkpoints (60; of the sky none in the first 10 unless given)"},
          {"--shard", "", "I/N", "make only share I of N, in OUT.I-of-N.grck; `greenray merge` puts them together"},
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
