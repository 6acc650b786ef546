// Timing of several methods in turn, so that all of them see the same good and bad moments of the machine.
#pragma once
#include <functional>
#include <vector>

namespace greenray::bench {

struct Timing {
  double best_wall_seconds = 0, median_wall_seconds = 0;
  double best_cpu_seconds = 0;  // the run with the least CPU time, not always the one with the least wall time
  int repeats = 0;
};

/// Runs every entry `repeats` times, one after the other in each round. They must be warm.
/// errors: Interrupted when a stop is asked for between runs
std::vector<Timing> race(const std::vector<std::function<void()>> &entries, int repeats,
                         const std::function<void(double fraction)> &progress = {});

/// Calls work(first, last) for pieces of 0..count on so many threads; pieces are taken as threads get free.
void on_threads(std::size_t count, std::size_t piece, unsigned threads,
                const std::function<void(std::size_t first, std::size_t last)> &work);

}  // namespace greenray::bench
