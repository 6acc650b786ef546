// What a benchmark run leaves behind: records with the keys that scripts rely on, and the file they stand in.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/kind.hpp"

namespace greenray::bench {

/// The peer's point that a record is held against.
struct PeerPoint {
  std::string name, version, variant;
  double rate = 0, error = 0;
  double ratio = 0;      // rate / peer rate, wall time of the best runs
  double cpu_ratio = 0;  // the same from CPU time: less disturbed on a shared machine
};

/// One method at one setting on one case.
struct Record {
  std::string suite, case_name, variant, device;
  Kind kind;
  double rate = 0;        // of the best run
  std::string rate_unit;  // "ray/s", "picture/s"
  double error = 0;
  std::string error_unit;
  double cpu_seconds = 0, wall_seconds = 0;  // of the best run; CPU: all threads of the process
  double median_rate = 0;
  int repeats = 0;
  std::optional<PeerPoint> peer;
  std::map<std::string, double> more;  // numbers beyond the contract, by name

  std::string key() const { return suite + " | " + case_name + " | " + variant; }
  /// The words of the variant before its first comma: one curve of a work-precision plot.
  std::string curve() const { return variant.substr(0, variant.find(", ")); }
  bool ours() const { return kind.by.empty(); }
  double number(const std::string &name, double otherwise = 0) const {
    const auto at = more.find(name);
    return at == more.end() ? otherwise : at->second;
  }
  /// (best - median)/best: what the machine's unrest does to the rate.
  double spread() const { return rate > 0 ? 1 - median_rate / rate : 0; }
};

/// A whole run. `about`: words on machine, load, build; kept with the records.
struct Results {
  std::map<std::string, std::string> about;
  std::string summary;  // one line fit for pasting
  bool contended = false;
  std::vector<Record> records;
};

std::string as_json(const Results &results);
/// The records as a table: lines of `# NAME: VALUE` about the run, one header row, one row a record. Text is quoted
/// where it holds a comma or a quote; a number that a record has not is an empty field.
std::string as_csv(const Results &results);
/// Throws InputError naming the file when it is no result of `greenray bench`.
Results read_results(const std::filesystem::path &path);

/// One human line.
std::string line_of(const Record &record);

struct Change {
  std::string key;
  double ratio;  // new rate / old rate
  double noise;  // relative: the larger spread of the two
  double error_ratio;
  bool slower, less_accurate;
};

struct Comparison {
  std::vector<Change> changes;  // in the order of the new file
  std::vector<std::string> only_old, only_new;
  std::vector<std::string> warnings;  // other machine, contended
  bool worse() const;
};

/// slower: the rate fell by more than `limit` (0.05: 5 %) and the noise together. less accurate: error more than
/// doubled. Noise counts at least 2 % and at most 25 %, so that a restless run cannot hide a real slow-down for ever.
Comparison compare(const Results &before, const Results &after, double limit);
std::string text_of(const Comparison &comparison, double limit);

}  // namespace greenray::bench
