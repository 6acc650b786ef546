// Peer: Boost.odeint's controlled Dormand-Prince 5(4) as it comes, in double, on host threads. What one would write
// first, from the textbook: (h, b, bending) over arc length s,
//   dh/ds = sin b,  db/ds = cos b (1/(R+h) + n'/n),  d(bending)/ds = -cos b n'/n,
// n'/n from the same table by binary search, and make_controlled(tolerance, tolerance) until the ray has left the air
// or met the ground. No steps that end at kinks, no cap on the step: what odeint_peer.cpp adds.
#include <boost/numeric/odeint.hpp>
#include <boost/version.hpp>
#include <cmath>
#include <sstream>

#include "bench/peer.hpp"
#include "bench/race.hpp"
#include "odeint_cells.hpp"

namespace greenray::bench {
namespace {

namespace odeint = boost::numeric::odeint;
using State = std::array<double, 3>;  // height [m], elevation [rad], bending [rad]

constexpr int most_steps = 100000;
constexpr double first_step_m = 100;

struct RayEquation {
  const std::vector<OdeCell> *cells;
  double curvature_per_m;

  double gradient(double height_m) const {
    if (height_m >= cells->back().top_m) return 0;
    const auto above = std::upper_bound(cells->begin() + 1, cells->end(), height_m,
                                        [](double h, const OdeCell &c) { return h < c.bottom_m; });
    return std::prev(above)->at(height_m);
  }
  void operator()(const State &y, State &slope, double) const {
    const double g = gradient(y[0]), cosine = std::cos(y[1]);
    slope[0] = std::sin(y[1]);
    slope[1] = cosine * (curvature_per_m / (1 + y[0] * curvature_per_m) + g);
    slope[2] = -cosine * g;
  }
};

class UntunedRunner : public Runner {
 public:
  UntunedRunner(const IndexTable &table, std::span<const f64::RayStart> starts, double tolerance, unsigned threads)
      : cells_(ode_cells(table, Form::classical)),
        curvature_per_m_(table.curvature_per_m),
        tolerance_(tolerance),
        threads_(threads),
        results_(starts.size()) {
    for (const f64::RayStart &s : starts) {
      const double z_m = table.cell(0, static_cast<std::size_t>(s.cell)).bottom_m + s.above_m;
      starts_.push_back({f64::geometric_height_m(z_m, curvature_per_m_), std::atan2(s.rise, s.run), 0});
    }
  }

  void run() override {
    on_threads(starts_.size(), 64, threads_, [this](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) results_[i] = trace(starts_[i]);
    });
  }
  Bent result(std::size_t ray) const override { return results_[ray]; }

 private:
  Bent trace(State y) const {
    const RayEquation equation{&cells_, curvature_per_m_};
    auto stepper = odeint::make_controlled(tolerance_, tolerance_, odeint::runge_kutta_dopri5<State>());
    double s = 0, step = first_step_m;
    int steps = 0;
    for (int tried = 0; tried < most_steps; ++tried) {
      if (stepper.try_step(equation, y, s, step) == odeint::fail) continue;
      ++steps;
      if (y[0] >= cells_.back().top_m) return {y[2], f64::RAY_SPACE, steps};  // nothing bends above
      if (y[0] <= 0) return {y[2], f64::RAY_GROUND, steps};
    }
    return {y[2], f64::RAY_LIMIT, steps};
  }

  std::vector<OdeCell> cells_;
  double curvature_per_m_, tolerance_;
  unsigned threads_;
  std::vector<State> starts_;
  std::vector<Bent> results_;
};

}  // namespace

std::vector<Method> untuned_odeint_methods(unsigned threads, bool few) {
  std::vector<Method> methods;
  constexpr double table_arcsec = 1e-3;
  for (const double tolerance : {1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 3e-10, 1e-10, 3e-11, 1e-11, 1e-12}) {
    if (few && tolerance != 1e-9) continue;
    std::ostringstream text;
    text << "odeint dopri5 double untuned, tolerance " << tolerance;
    methods.push_back({{"Boost.odeint dopri5, untuned", BOOST_LIB_VERSION, "dopri5", "double", 1},
                       text.str(),
                       "host, " + std::to_string(threads) + " threads",
                       table_arcsec,
                       tolerance,
                       [=](const IndexTable &table, std::span<const f64::RayStart> starts) {
                         return std::make_unique<UntunedRunner>(table, starts, tolerance, threads);
                       }});
  }
  return methods;
}

}  // namespace greenray::bench
