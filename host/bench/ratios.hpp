// The comparisons that a run can make by itself: ours against peers, one way against another, growth.
#pragma once
#include <string>
#include <vector>

#include "bench/record.hpp"

namespace greenray::bench {

/// How a ratio of speeds is measured.
enum class Basis {
  cpu,     // rays per second of CPU time: the steadier number on a shared machine
  wall,    // rays per second
  kernel,  // of the device's kernel alone, without queue and conversion, against the peer's wall time
  cost     // of one over the other, CPU time: smaller is better
};

/// One row of the table. Without a value the run has not what it takes; `note` says what is missing.
struct Ratio {
  std::string what, case_name;
  double value = 0;
  Basis basis = Basis::cpu;
  double floor = 0, aim = 0;  // asked of us; 0: nothing. Basis cost: not to be exceeded
  std::string ours, theirs;   // variants
  double our_error = 0, their_error = 0;
  std::string error_unit, note;

  bool measured() const { return value > 0; }
  /// "aim", "floor", "missed", or "" where nothing is asked or measured.
  std::string verdict() const;
};

/* Against a peer at a level of error E: the peer's fastest point with error <= E, and our fastest with an error no
   larger than that point's. Points with a wrong outcome count on neither side. Rows whose suite or case is not in the
   records are left out. On a device that is no CPU, `wall` stands in for `cpu`. */
std::vector<Ratio> ratios_of(const Results &results);

const char *basis_words(Basis basis);

/// One line a ratio, for a terminal.
std::string text_of(const std::vector<Ratio> &ratios);

}  // namespace greenray::bench
