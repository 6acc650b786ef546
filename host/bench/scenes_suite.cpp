// Suite scenes: shipped scenes rendered as `greenray render` does, seconds by phase beside the picture's errors.
#include <algorithm>

#include "bench/device_methods.hpp"
#include "bench/machine.hpp"
#include "bench/trace_suite.hpp"
#include "image/colour.hpp"
#include "image/develop.hpp"
#include "render/renderer.hpp"
#include "scene/scene_file.hpp"

namespace greenray::bench {
namespace {

struct Picture {
  Clocks took;
  double compile_seconds, eye_seconds;
  RenderReport report;
  double pixels;
};

Picture render_once(const Scene &scene, const RenderOptions &options, const std::shared_ptr<Device> &device) {
  const Clocks begin = clocks_now();
  const double compiled = device->compile_seconds();
  const RenderPlan plan = plan_render(scene, options);
  const Rendered rendered = render(scene, plan, options, device);
  const Clocks eye = clocks_now();
  (void)develop_camera(rgb_from_spectral(rendered.image), {scene.eye.exposure_ev, 8, true});
  const Clocks end = clocks_now();
  return {{end.wall_seconds - begin.wall_seconds, end.cpu_seconds - begin.cpu_seconds},
          device->compile_seconds() - compiled,
          end.wall_seconds - eye.wall_seconds,
          rendered.report,
          static_cast<double>(rendered.image.pixels())};
}

/// The first picture compiles and warms up: it counts only when it is alone.
Record record_of(const std::string &name, const std::vector<Picture> &all, const Device &device) {
  const double first_compile = all[0].compile_seconds;
  const std::vector<Picture> pictures(all.size() > 1 ? all.begin() + 1 : all.begin(), all.end());
  std::vector<double> wall, cpu;
  const Picture *best = &pictures[0];
  for (const Picture &p : pictures) {
    wall.push_back(p.took.wall_seconds);
    cpu.push_back(p.took.cpu_seconds);
    if (p.took.wall_seconds < best->took.wall_seconds) best = &p;
  }
  std::sort(wall.begin(), wall.end());
  const RenderReport &r = best->report;
  Record record;
  record.suite = "scenes";
  record.case_name = name;
  record.variant = "render and develop";
  record.device = device_words(device);
  record.rate = 1 / wall.front();
  record.rate_unit = "picture/s";
  record.error = r.table_arcsec + r.solver_arcsec + r.lookup_arcsec;
  record.error_unit = "arcsec";
  record.cpu_seconds = *std::min_element(cpu.begin(), cpu.end());
  record.wall_seconds = wall.front();
  record.median_rate = 1 / wall[wall.size() / 2];
  record.repeats = static_cast<int>(pictures.size());
  record.more = {{"pixels", best->pixels},
                 {"samples_per_pixel", r.spp},
                 {"rays", static_cast<double>(r.trace.rays)},
                 {"table_arcsec", r.table_arcsec},
                 {"solver_arcsec", r.solver_arcsec},
                 {"lookup_arcsec", r.lookup_arcsec},
                 {"noise_rms", r.noise_rms},
                 {"first_compile_seconds", first_compile},
                 {"compile_seconds", best->compile_seconds},
                 {"build_seconds", r.build_seconds},
                 {"emit_seconds", r.emit_seconds},
                 {"gather_seconds", r.gather_seconds},
                 {"eye_seconds", best->eye_seconds}};
  return record;
}

}  // namespace

std::vector<Record> run_scenes_suite(const SuiteOptions &options) {
  const std::shared_ptr<Device> device = open_device(options.device);
  std::vector<Record> records;
  for (const char *name : {"smoke", "green-flash"}) {
    const Scene scene = load_scene(name, {});
    RenderOptions render_options;
    render_options.quick = options.quick;
    std::vector<Picture> pictures;
    const int repeats = options.quick ? 1 : std::clamp(options.repeats / 2, 3, 5);
    for (int i = 0; i < repeats; ++i) {
      if (options.say)
        options.say(std::string(name) + ": picture " + std::to_string(i + 1) + " of " + std::to_string(repeats));
      pictures.push_back(render_once(scene, render_options, device));
    }
    records.push_back(record_of(name, pictures, *device));
    if (options.done) options.done(records.back());
  }
  for (Record &record : run_rooms(options, device)) records.push_back(std::move(record));
  return records;
}

}  // namespace greenray::bench
