// A method made ready to be timed on a case, and its record.
#pragma once
#include <memory>

#include "bench/race.hpp"
#include "bench/record.hpp"
#include "bench/trace_case.hpp"
#include "bench/trace_suite.hpp"

namespace greenray::bench {

struct Entrant {
  const Method *method;
  TraceCase *rays;
  std::unique_ptr<Runner> runner;
  std::size_t count = 0;  // rays of one run
  int runs = 1;           // that are timed together, so that the clock is not the limit
  Accuracy accuracy;
  double steps_per_ray = 0, prepare_seconds = 0;
  std::size_t cells = 0;
  double best_kernel_seconds = 1e30;
};

/// Runs the reference rays for the error, then takes `altitudes` of the timed ones; 0: as many as make a run long
/// enough. method and rays must outlive it.
Entrant prepare(const Method &method, TraceCase &rays, std::size_t altitudes = 0);

/// All in turn, options.repeats rounds; afterwards each knows its best kernel time.
std::vector<Timing> race(std::vector<Entrant> &entrants, const SuiteOptions &options);

Record record_of(const Entrant &entrant, const Timing &timing);

}  // namespace greenray::bench
