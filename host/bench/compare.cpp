#include <algorithm>
#include <iomanip>
#include <sstream>

#include "bench/record.hpp"

namespace greenray::bench {
namespace {

const Record *find(const std::vector<Record> &records, const std::string &key) {
  const auto at = std::find_if(records.begin(), records.end(), [&](const Record &r) { return r.key() == key; });
  return at == records.end() ? nullptr : &*at;
}

std::string about(const Results &results, const std::string &what) {
  const auto at = results.about.find(what);
  return at == results.about.end() ? "" : at->second;
}

constexpr double least_noise = 0.02, most_noise = 0.25;

}  // namespace

bool Comparison::worse() const {
  return std::any_of(changes.begin(), changes.end(), [](const Change &c) { return c.slower || c.less_accurate; });
}

Comparison compare(const Results &before, const Results &after, double limit) {
  Comparison result;
  for (const Record &now : after.records) {
    const Record *then = find(before.records, now.key());
    if (!then) {
      result.only_new.push_back(now.key());
      continue;
    }
    Change change{now.key(), then->rate > 0 ? now.rate / then->rate : 1, 0, 1, false, false};
    change.noise = std::clamp(std::max(now.spread(), then->spread()), least_noise, most_noise);
    change.error_ratio = then->error > 0 ? now.error / then->error : 1;
    change.slower = change.ratio < 1 - limit - change.noise;
    change.less_accurate = change.error_ratio > 2;
    result.changes.push_back(change);
  }
  for (const Record &then : before.records)
    if (!find(after.records, then.key())) result.only_old.push_back(then.key());
  for (const char *what : {"cpu", "device", "threads"})
    if (about(before, what) != about(after, what))
      result.warnings.push_back(std::string(what) + " differs: '" + about(before, what) + "' and '" +
                                about(after, what) + "'");
  if (before.contended) result.warnings.push_back("the old run was contended: do not publish");
  if (after.contended) result.warnings.push_back("the new run was contended: do not publish");
  return result;
}

std::string text_of(const Comparison &comparison, double limit) {
  std::ostringstream text;
  text << std::fixed;
  for (const std::string &warning : comparison.warnings) text << "warning: " << warning << "\n";
  for (const Change &c : comparison.changes) {
    text << std::setprecision(3) << std::setw(7) << c.ratio << " x +-" << std::setprecision(3) << c.noise << "  "
         << c.key;
    if (c.error_ratio < 0.99 || c.error_ratio > 1.01) text << "  (error " << c.error_ratio << " x)";
    if (c.slower) text << "  SLOWER";
    if (c.less_accurate) text << "  LESS ACCURATE";
    text << "\n";
  }
  for (const std::string &key : comparison.only_old) text << "only in the old file: " << key << "\n";
  for (const std::string &key : comparison.only_new) text << "only in the new file: " << key << "\n";
  const auto slower =
      std::count_if(comparison.changes.begin(), comparison.changes.end(), [](const Change &c) { return c.slower; });
  const auto vague = std::count_if(comparison.changes.begin(), comparison.changes.end(),
                                   [](const Change &c) { return c.less_accurate; });
  text << comparison.changes.size() << " records compared: " << slower << " slower by more than "
       << std::setprecision(1) << 100 * limit << " % beyond the noise, " << vague
       << " less accurate by more than 2 x\n";
  return text.str();
}

}  // namespace greenray::bench
