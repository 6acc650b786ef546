// How cost grows: with cores, with the number of rays and with the number of wavelengths.
#pragma once
#include <vector>

#include "bench/record.hpp"
#include "bench/trace_suite.hpp"

namespace greenray::bench {

/* Records of suite trace, in standard air, for the closed form and for Dormand-Prince in float:
     cases cores (number "threads"), rays ("rays") and wavelengths ("wavelengths"); each has "speed_up" and
     "cpu_speed_up": rays per second, and rays per second of CPU time, over those of the case's first record of the same
     method. A device that is no CPU sits out `cores`. */
std::vector<Record> run_scaling(const SuiteOptions &options);

}  // namespace greenray::bench
