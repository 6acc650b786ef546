// What a method of tracing rays looks like to the benchmark, whoever wrote it: ours on a device, or a peer on host
// threads.
#pragma once
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "atmosphere/index_table.hpp"
#include "bench/kind.hpp"
#include "twin/twin.hpp"

namespace greenray::bench {

/// Total bending of one ray and how it ended (RayOutcome).
struct Bent {
  double bending_rad = 0;
  int outcome = 0;
  int steps = 0;  // accepted
};

/// One method with its table and rays in place: run() does the rays' own work and nothing else, again and again.
class Runner {
 public:
  virtual ~Runner() = default;
  virtual void run() = 0;
  virtual Bent result(std::size_t ray) const = 0;
  virtual double kernel_seconds() const { return 0; }  // of the last run, where a device does the work
};

/// A method at one setting.
struct Method {
  Kind kind;
  std::string variant;  // "CURVE, SETTING": the words before the first comma name its work-precision curve
  std::string device;
  double table_arcsec = 0;   // error asked of the index table
  double tolerance_rad = 0;  // per step, in the method's own meaning
  std::function<std::unique_ptr<Runner>(const IndexTable &, std::span<const f64::RayStart>)> prepare;
  std::string only_case = {};  // the one case that it can do; "": all
};

/// Boost.odeint, tuned in every way we know (bench/odeint_peer.cpp) and as it comes (bench/odeint_untuned.cpp); linked
/// only where Boost was found.
std::vector<Method> odeint_methods(unsigned threads, bool few);
std::vector<Method> untuned_odeint_methods(unsigned threads, bool few);

/// palRefro of the Starlink Positional Astronomy Library (bench/pal_peer.cpp), on the one air it knows (pal_air.hpp);
/// linked only where PAL was found.
std::vector<Method> pal_methods(unsigned threads, bool few);

/// The kernels' own text as C++ for this processor, one lane and eight (bench/native_peer.cpp).
std::vector<Method> native_methods(unsigned threads, bool few);

}  // namespace greenray::bench
