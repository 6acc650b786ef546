// Peer: palRefro of the Starlink Positional Astronomy Library: refraction by Simpson's rule over the zenith distance
// along the ray (Hohenkerk & Sinclair 1985), in the one air it knows. It keeps no state: it may run on all threads.
// PAL comes under the GNU GPL, version 3 or later: a binary with this peer inside may be given away under those terms
// only.
#include <star/pal.h>

#include <cmath>
#include <sstream>

#include "bench/pal_air.hpp"
#include "bench/peer.hpp"
#include "bench/race.hpp"
#include "bench/trace_case.hpp"
#include "support/angle.hpp"

namespace greenray::bench {
namespace {

class PalRunner : public Runner {
 public:
  PalRunner(std::span<const f64::RayStart> starts, double tolerance_rad, unsigned threads)
      : tolerance_rad_(tolerance_rad), threads_(threads), bending_rad_(starts.size()) {
    for (const f64::RayStart &s : starts) zenith_distance_rad_.push_back(pi / 2 - std::atan2(s.rise, s.run));
  }

  void run() override {
    on_threads(bending_rad_.size(), 64, threads_, [this](std::size_t first, std::size_t last) {
      constexpr double dry = 0;
      for (std::size_t i = first; i < last; ++i)
        palRefro(zenith_distance_rad_[i], site_.eye_m, site_.temperature_K, site_.pressure_hPa, dry,
                 site_.wavelength_um, site_.latitude_rad, site_.lapse_K_m, tolerance_rad_, &bending_rad_[i]);
    });
  }
  Bent result(std::size_t ray) const override { return {bending_rad_[ray], f64::RAY_SPACE, 0}; }

 private:
  PalSite site_;
  double tolerance_rad_;
  unsigned threads_;
  std::vector<double> zenith_distance_rad_, bending_rad_;
};

std::string pal_version() {
  char text[32] = "";
  palVers(text, sizeof text);
  return text;
}

}  // namespace

std::vector<Method> pal_methods(unsigned threads, bool few) {
  std::vector<Method> methods;
  for (const double tolerance : {1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-12}) {
    if (few && tolerance != 1e-6 && tolerance != 1e-12) continue;
    std::ostringstream text;
    text << "palRefro double, tolerance " << tolerance;
    methods.push_back({{"PAL palRefro", pal_version(), "quadrature", "double", 1},
                       text.str(),
                       "host, " + std::to_string(threads) + " threads",
                       0.01,
                       tolerance,
                       [=](const IndexTable &, std::span<const f64::RayStart> starts) {
                         return std::make_unique<PalRunner>(starts, tolerance, threads);
                       },
                       pal_case});
  }
  return methods;
}

}  // namespace greenray::bench
