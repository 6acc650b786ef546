// The machine a benchmark runs on, and whether it had the machine to itself.
#pragma once
#include <string>

namespace greenray::bench {

struct Clocks {
  double wall_seconds = 0;
  double cpu_seconds = 0;  // of this process, all threads
};
Clocks clocks_now();

std::string cpu_name();
double clock_MHz();     // of the first core, now; 0 where the system does not say
double load_average();  // over one minute; 0 where the system does not say

/// Counts the processors that others keep busy between its making and the asking.
class Neighbours {
 public:
  Neighbours();
  /// Mean number of cores in use by other processes (and by the hypervisor); 0 where the system does not say.
  double cores() const;

 private:
  Clocks begin_;
  double busy_seconds_;
};

}  // namespace greenray::bench
