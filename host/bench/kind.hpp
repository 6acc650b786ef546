// What a method is, in words that records keep.
#pragma once
#include <string>

namespace greenray::bench {

/// Whose a method is and what it does; kept with its records.
struct Kind {
  std::string by, version;  // the peer; "" for our own kernels on a device
  std::string solver;       // "closed form", "rk45", "richardson", "dopri5", "quadrature"
  std::string precision;    // "float" or "double"
  int lanes = 1;
};

}  // namespace greenray::bench
