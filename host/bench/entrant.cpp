#include "bench/entrant.hpp"

#include <algorithm>
#include <cmath>

#include "bench/machine.hpp"

namespace greenray::bench {
namespace {

constexpr double longest_seconds = 0.2, shortest_seconds = 0.02;  // of what is timed at once

}  // namespace

Entrant prepare(const Method &method, TraceCase &rays, std::size_t altitudes) {
  const IndexTable &table = rays.table(method.table_arcsec);
  Entrant entrant{&method, &rays, nullptr, 0, 1, {}, 0, 0, table.cells_per_row, 1e30};
  const std::vector<f64::RayStart> checked = rays.starts(table, 0);
  const Clocks begin = clocks_now();
  const std::unique_ptr<Runner> check = method.prepare(table, checked);
  entrant.prepare_seconds = clocks_now().wall_seconds - begin.wall_seconds;
  check->run();
  const Clocks before = clocks_now();
  check->run();
  const double seconds = clocks_now().wall_seconds - before.wall_seconds;
  entrant.accuracy = rays.accuracy(*check);
  for (std::size_t i = 0; i < checked.size(); ++i)
    entrant.steps_per_ray += static_cast<double>(check->result(i).steps) / static_cast<double>(checked.size());
  if (altitudes == 0) {
    altitudes = rays.timed_rays();
    const double each = seconds / static_cast<double>(checked.size());
    while (altitudes > 1024 && each * static_cast<double>(altitudes) > longest_seconds) altitudes /= 2;
  }
  const std::vector<f64::RayStart> timed = rays.starts(table, altitudes);
  entrant.count = timed.size();
  entrant.runner = method.prepare(table, timed);
  entrant.runner->run();  // warm
  const Clocks start = clocks_now();
  entrant.runner->run();
  const double once = std::max(clocks_now().wall_seconds - start.wall_seconds, 1e-6);
  entrant.runs = static_cast<int>(std::clamp(std::ceil(shortest_seconds / once), 1.0, 1000.0));
  return entrant;
}

std::vector<Timing> race(std::vector<Entrant> &entrants, const SuiteOptions &options) {
  std::vector<std::function<void()>> runs;
  for (Entrant &e : entrants)
    runs.emplace_back([&e] {
      for (int i = 0; i < e.runs; ++i) {
        e.runner->run();
        if (e.runner->kernel_seconds() > 0)
          e.best_kernel_seconds = std::min(e.best_kernel_seconds, e.runner->kernel_seconds());
      }
    });
  std::vector<Timing> timings = race(runs, options.repeats, [&](double fraction) {
    if (options.say)
      options.say(entrants.front().rays->air().name + ": timed " + std::to_string(static_cast<int>(100 * fraction)) +
                  " %");
  });
  for (std::size_t i = 0; i < entrants.size(); ++i) {
    const double share = 1.0 / entrants[i].runs;
    timings[i].best_wall_seconds *= share, timings[i].median_wall_seconds *= share;
    timings[i].best_cpu_seconds *= share;
  }
  return timings;
}

Record record_of(const Entrant &e, const Timing &timing) {
  Record r;
  r.suite = "trace";
  r.case_name = e.rays->air().name;
  r.variant = e.method->variant;
  r.device = e.method->device;
  r.kind = e.method->kind;
  const auto count = static_cast<double>(e.count);
  r.rate = count / timing.best_wall_seconds;
  r.rate_unit = "ray/s";
  r.error = e.accuracy.error_arcsec;
  r.error_unit = "arcsec";
  r.cpu_seconds = timing.best_cpu_seconds;
  r.wall_seconds = timing.best_wall_seconds;
  r.median_rate = count / timing.median_wall_seconds;
  r.repeats = timing.repeats;
  r.more = {{"rays", count},
            {"runs_timed_together", static_cast<double>(e.runs)},
            {"scaled_error_arcsec", e.accuracy.scaled_error_arcsec},
            {"wrong_outcomes", e.accuracy.wrong_outcomes},
            {"steps_per_ray", e.steps_per_ray},
            {"cells", static_cast<double>(e.cells)},
            {"prepare_seconds", e.prepare_seconds},
            {"reference_error_arcsec", e.rays->reference_error_arcsec()},
            {"lowest_altitude_deg", e.rays->lowest_deg()}};
  if (e.best_kernel_seconds < 1e29) r.more["kernel_rate"] = count / e.best_kernel_seconds;
  return r;
}

}  // namespace greenray::bench
