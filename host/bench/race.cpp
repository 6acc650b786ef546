#include "bench/race.hpp"

#include <algorithm>
#include <atomic>
#include <thread>

#include "bench/machine.hpp"
#include "render/renderer.hpp"
#include "support/error.hpp"

namespace greenray::bench {

std::vector<Timing> race(const std::vector<std::function<void()>> &entries, int repeats,
                         const std::function<void(double)> &progress) {
  std::vector<std::vector<double>> wall(entries.size()), cpu(entries.size());
  for (int round = 0; round < repeats; ++round) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (stop_requested()) throw Interrupted();
      const Clocks begin = clocks_now();
      entries[i]();
      const Clocks end = clocks_now();
      wall[i].push_back(end.wall_seconds - begin.wall_seconds);
      cpu[i].push_back(end.cpu_seconds - begin.cpu_seconds);
    }
    if (progress) progress((round + 1.0) / repeats);
  }
  std::vector<Timing> timings;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    std::sort(wall[i].begin(), wall[i].end());
    timings.push_back(
        {wall[i].front(), wall[i][wall[i].size() / 2], *std::min_element(cpu[i].begin(), cpu[i].end()), repeats});
  }
  return timings;
}

void on_threads(std::size_t count, std::size_t piece, unsigned threads,
                const std::function<void(std::size_t, std::size_t)> &work) {
  std::atomic<std::size_t> next{0};
  const auto take = [&] {
    for (std::size_t first; (first = next.fetch_add(piece)) < count;) work(first, std::min(first + piece, count));
  };
  std::vector<std::thread> others;
  for (unsigned i = 1; i < threads; ++i) others.emplace_back(take);
  take();
  for (std::thread &thread : others) thread.join();
}

}  // namespace greenray::bench
