#include "bench/trace_suite.hpp"

#include <algorithm>
#include <cmath>

#include "bench/device_methods.hpp"
#include "bench/entrant.hpp"
#include "bench/scaling.hpp"

namespace greenray::bench {
namespace {

constexpr const char *tuned = "Boost.odeint dopri5", *untuned = "Boost.odeint dopri5, untuned", *pal = "PAL palRefro";

bool has(const std::string &text, const std::string &words) { return text.find(words) != std::string::npos; }

double cpu_rate(const Record &r) { return r.number("rays") / std::max(r.cpu_seconds, 1e-9); }

/// The points of one peer that ended every ray where the reference does.
std::vector<Record> points_of(const std::vector<Record> &records, const std::string &peer) {
  std::vector<Record> points;
  for (const Record &r : records)
    if (r.kind.by == peer && r.number("wrong_outcomes") == 0) points.push_back(r);
  return points;
}

/// The peer of the case: palRefro where it can do the job, Boost.odeint otherwise. Apart from it, odeint in its
/// classical formulation and odeint untuned.
void compare_with_peers(std::vector<Record> &records) {
  const std::vector<Record> pal_points = points_of(records, pal), tuned_points = points_of(records, tuned);
  const std::vector<Record> untuned_points = points_of(records, untuned);
  const std::vector<Record> &main = pal_points.empty() ? tuned_points : pal_points;
  std::vector<Record> classical = tuned_points;
  std::erase_if(classical, [](const Record &r) { return !has(r.variant, "classical"); });
  for (Record &r : records) {
    if (r.number("wrong_outcomes") > 0 || has(r.kind.by, "Boost") || r.kind.by == pal) continue;
    r.peer = fair_peer(r, main);
    if (const auto point = fair_peer(r, classical))
      r.more["classical_ratio"] = point->ratio, r.more["classical_error"] = point->error;
    if (const auto point = fair_peer(r, untuned_points))
      r.more["untuned_ratio"] = point->ratio, r.more["untuned_error"] = point->error;
  }
}

bool takes_part(const Method &method, const CaseAir &air) {
  if (!method.only_case.empty() && method.only_case != air.name) return false;
  return std::none_of(air.without.begin(), air.without.end(),
                      [&](const std::string &words) { return has(method.variant, words); });
}

std::vector<Record> run_case(TraceCase &rays, const std::vector<Method> &methods, const SuiteOptions &options) {
  std::vector<Entrant> entrants;
  for (const Method &method : methods) {
    if (!takes_part(method, rays.air())) continue;
    if (options.say) options.say(rays.air().name + ": prepare " + method.variant);
    entrants.push_back(prepare(method, rays));
  }
  const std::vector<Timing> timings = race(entrants, options);
  std::vector<Record> records;
  for (std::size_t i = 0; i < entrants.size(); ++i) records.push_back(record_of(entrants[i], timings[i]));
  compare_with_peers(records);
  if (options.done)
    for (const Record &r : records) options.done(r);
  return records;
}

}  // namespace

std::optional<PeerPoint> fair_peer(const Record &ours, const std::vector<Record> &points) {
  const Record *best = nullptr;
  for (const Record &p : points) {
    const bool beaten = std::any_of(points.begin(), points.end(),
                                    [&](const Record &other) { return other.error <= p.error && other.rate > p.rate; });
    if (beaten || p.error < ours.error) continue;
    if (!best || p.error < best->error) best = &p;
  }
  if (!best) return std::nullopt;
  return PeerPoint{best->kind.by,
                   best->kind.version,
                   best->variant,
                   best->rate,
                   best->error,
                   ours.rate / best->rate,
                   cpu_rate(ours) / cpu_rate(*best)};
}

std::vector<Record> run_trace_suite(const SuiteOptions &options, const std::vector<Method> &peers) {
  std::vector<Method> methods = device_methods(options.device, options.quick);
  methods.insert(methods.end(), peers.begin(), peers.end());
  std::erase_if(methods, [&](const Method &m) { return !has(m.variant, options.only); });
  std::vector<Record> all;
  const auto keep = [&](std::vector<Record> records) {
    all.insert(all.end(), std::make_move_iterator(records.begin()), std::make_move_iterator(records.end()));
  };
  for (const CaseAir &air : trace_cases()) {
    if (std::none_of(methods.begin(), methods.end(), [&](const Method &m) { return takes_part(m, air); })) continue;
    if (options.say) options.say(air.name + ": reference");
    TraceCase rays(air, options.quick ? 1024 : 262144, options.quick ? 60 : 1928, options.threads);
    keep(run_case(rays, methods, options));
  }
  keep(run_scaling(options));
  return all;
}

}  // namespace greenray::bench
