// Suite images: seconds of whole pictures against their RMS error, filled from the transfer table or traced pixel by
// pixel.
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "bench/device_methods.hpp"
#include "bench/machine.hpp"
#include "bench/trace_suite.hpp"
#include "render/renderer.hpp"
#include "scene/scene_file.hpp"
#include "support/angle.hpp"

namespace greenray::bench {
namespace {

/// One way to make the picture.
struct Way {
  bool per_pixel = false;
  bool steps = false;  // rays by adaptive steps, not in closed form
  int samples = 1;     // a pixel
  bool fine = false;   // the reference: double, table and steps a hundred times finer
  std::uint64_t seed = 1;
  std::string name() const { return per_pixel ? steps ? "per pixel, steps" : "per pixel" : "transfer table"; }
};

/// A picture of the low Sun. Per-pixel tracing may be timed on a strip of its middle columns, which has its share of
/// every altitude; errors are measured on a narrower one. A strip is a picture of its own, as high and less wide.
struct Case {
  int width, height, wavelengths;
  int timed_columns, checked_columns;
  std::vector<Way> ways;
  Way reference;
  std::string name() const { return "sun-" + std::to_string(width) + "x" + std::to_string(height); }
};

struct Shot {
  SpectralImage image;
  RenderReport report;
  double wall_seconds = 0, cpu_seconds = 0;  // of the whole picture, without compiling
};

constexpr double field_deg = 0.8, sun_right_deg = 0.12;  // so that the middle columns cross the limb aslant

Scene scene_of(const Case &c, const Way &way, int columns) {
  const double half = std::tan(to_rad(field_deg / 2)) * columns / c.width;
  std::ostringstream field;
  field << std::setprecision(15) << "observer.fov_deg=" << 2 * to_deg(std::atan(half));
  std::vector<std::string> keys{
      "observer.resolution=[" + std::to_string(columns) + ", " + std::to_string(c.height) + "]",
      field.str(),
      "observer.azimuth_deg=270.0",
      "sun.azimuth_deg=" + std::to_string(270 + sun_right_deg),
      "spectrum.samples=" + std::to_string(c.wavelengths),
      "tracing.quality={ spp = " + std::to_string(way.samples) + " }",
      std::string("tracing.method=\"") + (way.steps ? "rk45" : "auto") + "\"",
      std::string("tracing.transfer=\"") + (way.per_pixel ? "per-pixel" : "table") + "\""};
  if (way.fine)
    for (const char *key : {"tracing.precision=\"double\"", "tracing.table_arcsec=3e-5", "tracing.tolerance=1e-11"})
      keys.emplace_back(key);
  return load_scene("flat-sun", keys);
}

/// What grows with the pixels of a strip is counted as often as the strip fits into the picture.
Shot take(const Case &c, const Way &way, int columns, const std::shared_ptr<Device> &device) {
  const Scene scene = scene_of(c, way, columns);
  RenderOptions options;
  options.seed = way.seed;
  const RenderPlan plan = plan_render(scene, options);
  const double compiled_before = device->compile_seconds();
  const Clocks begin = clocks_now();
  Rendered rendered = render(scene, plan, options, device);
  const Clocks end = clocks_now();
  const double compiled = device->compile_seconds() - compiled_before;
  Shot shot{std::move(rendered.image), rendered.report};
  const double wall = end.wall_seconds - begin.wall_seconds - compiled;
  const double pixels = std::clamp(shot.report.gather_seconds, 0.0, wall);
  shot.wall_seconds = wall + pixels * (double(c.width) / columns - 1);
  shot.cpu_seconds = (end.cpu_seconds - begin.cpu_seconds) * shot.wall_seconds / wall;
  return shot;
}

/// RMS of the difference over all pixels and wavelengths, relative to the reference's own RMS.
double relative_rms(const SpectralImage &image, const SpectralImage &reference) {
  double error = 0, light = 0;
  for (std::size_t i = 0; i < reference.radiance.size(); ++i) {
    const double truth = reference.radiance[i], difference = image.radiance[i] - truth;
    error += difference * difference, light += truth * truth;
  }
  return light > 0 ? std::sqrt(error / light) : 0;
}

Record record_of(const Case &c, const Way &way, const std::vector<Shot> &shots, double error, const Device &device) {
  const auto faster = [](const Shot &a, const Shot &b) { return a.wall_seconds < b.wall_seconds; };
  std::vector<double> wall, cpu;
  for (const Shot &s : shots) wall.push_back(s.wall_seconds), cpu.push_back(s.cpu_seconds);
  std::sort(wall.begin(), wall.end());
  const Shot &best = *std::min_element(shots.begin(), shots.end(), faster);
  Record r;
  r.suite = "images";
  r.case_name = c.name();
  r.kind = {"", "", way.name(), "float", device.lanes().lanes_float};
  r.variant =
      r.kind.solver + ", " + std::to_string(way.samples) + (way.samples == 1 ? " sample" : " samples") + " a pixel";
  r.device = device_words(device);
  r.rate = 1 / wall.front();
  r.rate_unit = "picture/s";
  r.error = error;
  r.error_unit = "relative RMS";
  r.cpu_seconds = *std::min_element(cpu.begin(), cpu.end());
  r.wall_seconds = wall.front();
  r.median_rate = 1 / wall[wall.size() / 2];
  r.repeats = static_cast<int>(shots.size());
  r.more = {{"pixels", double(c.width) * c.height},
            {"wavelengths", double(c.wavelengths)},
            {"samples_per_pixel", double(way.samples)},
            {"timed_share", double(best.image.width) / c.width},
            {"rays", static_cast<double>(best.report.trace.rays)},
            {"table_arcsec", best.report.table_arcsec},
            {"lookup_arcsec", best.report.lookup_arcsec},
            {"solver_arcsec", best.report.solver_arcsec},
            {"build_seconds", best.report.build_seconds},
            {"emit_seconds", best.report.emit_seconds},
            {"gather_seconds", best.report.gather_seconds}};
  return r;
}

/// Many samples, other ones than the pictures': what finite sampling costs is in the error. One sample, the same as the
/// pictures': only what the methods themselves cost.
std::vector<Case> cases(bool quick) {
  const auto table = [](int samples) { return Way{false, false, samples}; };
  const auto pixel = [](int samples) { return Way{true, false, samples}; };
  const Way steps{true, true, 1}, same_samples{true, false, 1, true, 1}, many_samples{true, false, 64, true, 2};
  if (quick) return {{48, 27, 3, 48, 48, {table(1), pixel(1), steps}, same_samples}};
  return {{240, 135, 24, 240, 8, {table(1), table(4), table(16), pixel(1), pixel(4)}, many_samples},
          {1920, 1080, 24, 240, 8, {table(1), pixel(1), steps}, same_samples}};
}

std::vector<Record> run_case(const Case &c, const SuiteOptions &options, const std::shared_ptr<Device> &device) {
  std::vector<Way> ways = c.ways;
  std::erase_if(ways, [&](const Way &w) { return w.name().find(options.only) == std::string::npos; });
  if (ways.empty()) return {};
  const auto say = [&](const std::string &what) {
    if (options.say) options.say(c.name() + ": " + what);
  };
  say("reference");
  const SpectralImage reference = take(c, c.reference, c.checked_columns, device).image;
  std::vector<double> errors;
  for (const Way &way : ways) errors.push_back(relative_rms(take(c, way, c.checked_columns, device).image, reference));
  std::vector<std::vector<Shot>> shots(ways.size());
  const int repeats = options.quick ? 1 : std::clamp(options.repeats / 2, 1, 3);
  for (int round = 0; round < repeats; ++round)
    for (std::size_t i = 0; i < ways.size(); ++i) {
      say(ways[i].name() + ", " + std::to_string(ways[i].samples) + " a pixel");
      shots[i].push_back(take(c, ways[i], ways[i].per_pixel ? c.timed_columns : c.width, device));
    }
  std::vector<Record> records;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    records.push_back(record_of(c, ways[i], shots[i], errors[i], *device));
    if (options.done) options.done(records.back());
  }
  return records;
}

}  // namespace

std::vector<Record> run_images_suite(const SuiteOptions &options) {
  const std::shared_ptr<Device> device = open_device(options.device);
  std::vector<Record> all;
  for (const Case &c : cases(options.quick)) {
    const std::vector<Record> records = run_case(c, options, device);
    all.insert(all.end(), records.begin(), records.end());
  }
  return all;
}

}  // namespace greenray::bench
