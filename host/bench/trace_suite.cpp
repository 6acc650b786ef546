#include "bench/trace_suite.hpp"

#include <algorithm>
#include <cmath>

#include "bench/device_methods.hpp"
#include "bench/machine.hpp"
#include "bench/race.hpp"
#include "bench/trace_case.hpp"

namespace greenray::bench {
namespace {

/// A method ready to be timed on a case.
struct Entrant {
  const Method *method;
  std::unique_ptr<Runner> runner;
  std::size_t rays;
  Accuracy accuracy;
  double steps_per_ray, compile_seconds;
  std::size_t cells;
  double best_kernel_seconds = 1e30;
};

constexpr double wanted_seconds = 0.2;  // of one timed run

/// Runs the reference rays for the error, then takes as many timed rays as make a run long enough.
Entrant prepare(const Method &method, TraceCase &rays) {
  const IndexTable &table = rays.table(method.table_arcsec);
  Entrant entrant{&method, nullptr, 0, {}, 0, 0, table.cells_per_row, 1e30};
  const std::vector<f64::RayStart> checked = rays.starts(table, 0);
  const Clocks begin = clocks_now();
  const std::unique_ptr<Runner> check = method.prepare(table, checked);
  entrant.compile_seconds = clocks_now().wall_seconds - begin.wall_seconds;
  check->run();
  const Clocks before = clocks_now();
  check->run();
  const double seconds = clocks_now().wall_seconds - before.wall_seconds;
  entrant.accuracy = rays.accuracy(*check);
  for (std::size_t i = 0; i < checked.size(); ++i)
    entrant.steps_per_ray += static_cast<double>(check->result(i).steps) / static_cast<double>(checked.size());
  entrant.rays = rays.timed_rays();
  const double each = seconds / static_cast<double>(checked.size());
  while (entrant.rays > 1024 && each * static_cast<double>(entrant.rays) > wanted_seconds) entrant.rays /= 2;
  entrant.runner = method.prepare(table, rays.starts(table, entrant.rays));
  entrant.runner->run();  // warm
  return entrant;
}

Record record_of(const Entrant &e, const Timing &timing, const TraceCase &rays) {
  Record r;
  r.suite = "trace";
  r.case_name = rays.air().name;
  r.variant = e.method->variant;
  r.device = e.method->device;
  const auto count = static_cast<double>(e.rays);
  r.rate = count / timing.best_wall_seconds;
  r.rate_unit = "ray/s";
  r.error = e.accuracy.error_arcsec;
  r.error_unit = "arcsec";
  r.cpu_seconds = timing.best_cpu_seconds;
  r.wall_seconds = timing.best_wall_seconds;
  r.median_rate = count / timing.median_wall_seconds;
  r.repeats = timing.repeats;
  r.more = {{"rays", count},
            {"scaled_error_arcsec", e.accuracy.scaled_error_arcsec},
            {"wrong_outcomes", e.accuracy.wrong_outcomes},
            {"steps_per_ray", e.steps_per_ray},
            {"cells", static_cast<double>(e.cells)},
            {"prepare_seconds", e.compile_seconds},
            {"reference_error_arcsec", rays.reference_error_arcsec()},
            {"lowest_altitude_deg", rays.lowest_deg()}};
  if (e.best_kernel_seconds < 1e29) r.more["kernel_rate"] = count / e.best_kernel_seconds;
  return r;
}

double cpu_rate(const Record &r) { return r.more.at("rays") / std::max(r.cpu_seconds, 1e-9); }

/// Against every point of the peer, and apart from that against those in its classical formulation.
void compare_with_peer(Record &ours, const std::vector<Record> &points, const std::string &peer,
                       const std::string &version) {
  ours.peer = fair_peer(ours, points, peer, version);
  std::vector<Record> classical;
  for (const Record &p : points)
    if (p.variant.find("classical") != std::string::npos) classical.push_back(p);
  if (const auto point = fair_peer(ours, classical, peer, version)) {
    ours.more["classical_ratio"] = point->ratio;
    ours.more["classical_error"] = point->error;
  }
}

std::vector<Record> run_case(TraceCase &rays, const std::vector<Method> &methods, const SuiteOptions &options) {
  std::vector<Entrant> entrants;
  for (const Method &method : methods) {
    if (options.say) options.say(rays.air().name + ": prepare " + method.variant);
    entrants.push_back(prepare(method, rays));
  }
  std::vector<std::function<void()>> runs;
  for (Entrant &e : entrants)
    runs.emplace_back([&e] {
      e.runner->run();
      if (e.runner->kernel_seconds() > 0)
        e.best_kernel_seconds = std::min(e.best_kernel_seconds, e.runner->kernel_seconds());
    });
  const std::vector<Timing> timings = race(runs, options.repeats, [&](double fraction) {
    if (options.say)
      options.say(rays.air().name + ": timed " + std::to_string(static_cast<int>(100 * fraction)) + " %");
  });

  std::vector<Record> records, peer_points;
  std::string peer, version;
  for (std::size_t i = 0; i < entrants.size(); ++i) {
    records.push_back(record_of(entrants[i], timings[i], rays));
    if (entrants[i].method->peer.rfind("Boost", 0) != 0) continue;
    peer = entrants[i].method->peer, version = entrants[i].method->version;
    if (entrants[i].accuracy.wrong_outcomes == 0) peer_points.push_back(records.back());
  }
  for (std::size_t i = 0; i < entrants.size(); ++i) {
    const bool is_the_peer = entrants[i].method->peer == peer && !peer.empty();
    if (!is_the_peer && entrants[i].accuracy.wrong_outcomes == 0)
      compare_with_peer(records[i], peer_points, peer, version);
    if (options.done) options.done(records[i]);
  }
  return records;
}

}  // namespace

std::optional<PeerPoint> fair_peer(const Record &ours, const std::vector<Record> &points, const std::string &name,
                                   const std::string &version) {
  const Record *best = nullptr;
  for (const Record &p : points) {
    const bool beaten = std::any_of(points.begin(), points.end(),
                                    [&](const Record &other) { return other.error <= p.error && other.rate > p.rate; });
    if (beaten || p.error < ours.error) continue;
    if (!best || p.error < best->error) best = &p;
  }
  if (!best) return std::nullopt;
  return PeerPoint{
      name, version, best->variant, best->rate, best->error, ours.rate / best->rate, cpu_rate(ours) / cpu_rate(*best)};
}

std::vector<Record> run_trace_suite(const SuiteOptions &options, const std::vector<Method> &peers) {
  std::vector<Method> methods = device_methods(options.device, options.quick);
  methods.insert(methods.end(), peers.begin(), peers.end());
  std::erase_if(methods, [&](const Method &m) { return m.variant.find(options.only) == std::string::npos; });
  std::vector<Record> all;
  for (const CaseAir &air : trace_cases()) {
    if (options.say) options.say(air.name + ": reference");
    TraceCase rays(air, options.quick ? 1024 : 32768, options.threads);
    const std::vector<Record> records = run_case(rays, methods, options);
    all.insert(all.end(), records.begin(), records.end());
  }
  return all;
}

}  // namespace greenray::bench
