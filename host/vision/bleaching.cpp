#include "vision/bleaching.hpp"

#include <cmath>
#include <limits>

namespace greenray::vision {

double steady_unbleached(double td, const Pigment &pigment) { return 1.0 / (1.0 + td / pigment.half_bleach_td); }

double unbleached_after(double before, double td, double seconds, const Pigment &pigment) {
  const double steady = steady_unbleached(td, pigment);
  if (before == steady || seconds <= 0) return before;  // also keeps 1 at 1 in the dark, for any time
  return steady + (before - steady) * std::exp(-seconds / (pigment.time_constant_s * steady));
}

double half_bleach_seconds(double td, const Pigment &pigment) {
  const double steady = steady_unbleached(td, pigment);
  if (!(steady < 0.5)) return std::numeric_limits<double>::infinity();
  return pigment.time_constant_s * steady * std::log((1.0 - steady) / (0.5 - steady));
}

}  // namespace greenray::vision
