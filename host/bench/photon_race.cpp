#include <algorithm>

#include "bench/photon_suites.hpp"
#include "bench/race.hpp"

namespace greenray::bench {

std::vector<Record> race_group(std::vector<Contender> &group, const SuiteOptions &options, const std::string &peer,
                               const std::string &version) {
  std::vector<std::function<void()>> runs;
  for (Contender &c : group) {
    if (options.say) options.say(c.record.case_name + ": warm up " + c.record.variant);
    c.run();
    runs.push_back(c.run);
  }
  const std::vector<Timing> timings = race(runs, options.repeats, [&](double fraction) {
    if (options.say)
      options.say(group[0].record.case_name + ": timed " + std::to_string(static_cast<int>(100 * fraction)) + " %");
  });
  std::vector<Record> records;
  for (std::size_t i = 0; i < group.size(); ++i) {
    Record r = group[i].record;
    r.rate = group[i].count / timings[i].best_wall_seconds;
    r.median_rate = group[i].count / timings[i].median_wall_seconds;
    r.wall_seconds = timings[i].best_wall_seconds;
    r.cpu_seconds = timings[i].best_cpu_seconds;
    r.repeats = timings[i].repeats;
    records.push_back(std::move(r));
  }
  for (std::size_t i = 0; i < group.size(); ++i) {
    if (group[i].is_peer) continue;
    const Record *best = nullptr;
    for (std::size_t j = 0; j < group.size(); ++j)
      if (group[j].is_peer && records[j].error >= records[i].error * 0.999 && (!best || records[j].rate > best->rate))
        best = &records[j];
    if (best)
      records[i].peer = PeerPoint{peer,
                                  version,
                                  best->variant,
                                  best->rate,
                                  best->error,
                                  records[i].rate / best->rate,
                                  best->cpu_seconds / group[i].count / (records[i].cpu_seconds / group[i].count)};
  }
  if (options.done)
    for (const Record &r : records) options.done(r);
  return records;
}

}  // namespace greenray::bench
