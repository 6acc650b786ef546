// Peer: Boost.odeint's controlled Dormand-Prince 5(4) in double, on host threads, given every fair chance:
//   - the same tabulated medium; the cell of the last look-up is tried before the binary search;
//   - two ways to write the ray: classical (h, b, bending) over arc length s with sine and cosine,
//       dh/ds = sin b,  db/ds = cos b (1/(R+h) + n'/n),  d(bending)/ds = -cos b n'/n,
//     and ours over sigma without them, dz = p, dp = N^2 (1/R + g), d(bending) = -N_x g in flattened height;
//     for the classical one the cells are fitted anew in geometric height, so that no logarithm is taken on the way;
//   - steps end at kinks only, at every fourth knot or at every knot; landing there by the method's own dense output,
//   so it costs no step;
//   - first-same-as-last is used within a segment; the unit of height is tuned.
#include <algorithm>
#include <array>
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
using State = std::array<double, 3>;  // height in units of height_unit_m, direction, bending

constexpr double height_unit_m = 1e4;
constexpr int most_steps = 100000;

enum class StepEnds { kinks, fourth_knots, knots };

/// Cells between two step ends; inside, the medium is smooth up to the table's own error.
struct Segment {
  std::size_t first, last;
  double bottom_m, top_m;
};

struct Medium {
  std::vector<OdeCell> cells;
  std::vector<Segment> segments;
  double curvature_per_m = 0;

  std::size_t find(double height_m, const Segment &within, std::size_t guess) const {
    if (height_m >= cells[guess].bottom_m && height_m < cells[guess].top_m) return guess;
    const auto begin = cells.begin() + static_cast<std::ptrdiff_t>(within.first + 1);
    const auto end = cells.begin() + static_cast<std::ptrdiff_t>(within.last + 1);
    const auto above =
        std::upper_bound(begin, end, height_m, [](double h, const OdeCell &c) { return h < c.bottom_m; });
    return static_cast<std::size_t>(above - cells.begin()) - 1;
  }
};

Medium medium_of(const IndexTable &table, Form form, StepEnds ends) {
  Medium medium;
  medium.curvature_per_m = table.curvature_per_m;
  medium.cells = ode_cells(table, form);
  for (std::size_t i = 0; i < medium.cells.size(); ++i) {
    const OdeCell &c = medium.cells[i];
    const double before = i == 0 ? 0 : medium.cells[i - 1].at(c.bottom_m), here = c.at(c.bottom_m);
    const bool kink = i == 0 || std::abs(here - before) > 1e-3 * std::max(std::abs(here), std::abs(before));
    const std::size_t longest = ends == StepEnds::knots ? 1 : ends == StepEnds::fourth_knots ? 4 : medium.cells.size();
    if (kink || i - medium.segments.back().first >= longest) medium.segments.push_back({i, i, c.bottom_m, c.top_m});
    else medium.segments.back().last = i, medium.segments.back().top_m = c.top_m;
  }
  return medium;
}

/// Right-hand side, and the height's second derivative for the way to the next step end.
struct Ray {
  const Medium *medium;
  const Segment *segment;
  Form form;
  double run;  // N_x
  mutable std::size_t cell;

  double gradient(double height_m) const {
    cell = medium->find(height_m, *segment, cell);
    return medium->cells[cell].at(height_m);
  }
  void operator()(const State &y, State &slope, double) const {
    const double height_m = y[0] * height_unit_m, g = gradient(height_m);
    if (form == Form::flattened) {
      slope[0] = y[1] * (1 / height_unit_m);
      slope[1] = (run * run + y[1] * y[1]) * (medium->curvature_per_m + g);
      slope[2] = -run * g;
      return;
    }
    const double k = medium->curvature_per_m, sine = std::sin(y[1]), cosine = std::cos(y[1]);
    slope[0] = sine * (1 / height_unit_m);
    slope[1] = cosine * (k / (1 + height_m * k) + g);
    slope[2] = -cosine * g;
  }
};

using Stepper = odeint::runge_kutta_dopri5<State>;
using Controlled = odeint::result_of::make_controlled<Stepper>::type;

/// Path to the step end ahead by height's own parabola, a little more so that one step gets there; to the turning point
/// and half as far again where that comes first.
double path_to_end(const State &y, const State &slope, const Segment &s, Form form) {
  const double p = slope[0] * height_unit_m;
  const double force = form == Form::flattened ? slope[1] : std::cos(y[1]) * slope[1];
  const double ahead = (p > 0 || (p == 0 && force > 0) ? s.top_m : s.bottom_m) - y[0] * height_unit_m;
  const double discriminant = p * p + 2 * force * ahead;
  if (discriminant < 0) return 1.5 * std::abs(p / force) + 1;
  const double denominator = std::abs(p) + std::sqrt(discriminant);
  return denominator > 0 ? 1.01 * 2 * std::abs(ahead) / denominator + 1e-3 : 1e6;
}

class OdeintRunner : public Runner {
 public:
  OdeintRunner(const IndexTable &table, std::span<const f64::RayStart> starts, Form form, StepEnds ends,
               double tolerance, unsigned threads)
      : medium_(medium_of(table, form, ends)),
        form_(form),
        tolerance_(tolerance),
        threads_(threads),
        results_(starts.size()) {
    for (const f64::RayStart &s : starts) {
      const double z_m = table.cell(0, static_cast<std::size_t>(s.cell)).bottom_m + s.above_m;
      const bool flattened = form == Form::flattened;
      const double height_m = flattened ? z_m : f64::geometric_height_m(z_m, table.curvature_per_m);
      starts_.push_back({{height_m / height_unit_m, flattened ? s.rise : std::atan2(s.rise, s.run), 0},
                         s.run,
                         static_cast<std::size_t>(s.cell)});
    }
  }

  void run() override {
    on_threads(starts_.size(), 64, threads_, [this](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) results_[i] = trace(starts_[i]);
    });
  }
  Bent result(std::size_t ray) const override { return results_[ray]; }

 private:
  struct Start {
    State y;
    double run;
    std::size_t cell;
  };

  Bent trace(const Start &start) const {
    const auto of_cell = [&](std::size_t cell) {
      std::size_t i = 0;
      while (medium_.segments[i].last < cell) ++i;
      return i;
    };
    std::size_t segment = of_cell(start.cell);
    Ray ray{&medium_, &medium_.segments[segment], form_, start.run, start.cell};
    Controlled controlled = odeint::make_controlled(tolerance_, tolerance_, Stepper());
    State y = start.y, slope, next, next_slope;
    ray(y, slope, 0);
    double wish = 1000;
    for (int steps = 1; steps < most_steps; ++steps) {
      double s = 0, h = std::min(wish, path_to_end(y, slope, *ray.segment, form_));
      const double tried = h;
      if (controlled.try_step(ray, y, slope, s, next, next_slope, h) == odeint::fail) {
        wish = h;
        continue;
      }
      wish = tried < wish ? std::max(h, wish) : h;
      const double edge_m = next[0] * height_unit_m > ray.segment->top_m      ? ray.segment->top_m
                            : next[0] * height_unit_m < ray.segment->bottom_m ? ray.segment->bottom_m
                                                                              : -1;
      if (edge_m < 0) {
        y = next, slope = next_slope;
        continue;
      }
      y = land(controlled.stepper(), y, slope, next, next_slope, s, edge_m);
      const bool up = edge_m == ray.segment->top_m;
      if (up && segment + 1 == medium_.segments.size()) return {y[2], f64::RAY_SPACE, steps};
      if (!up && segment == 0) return {y[2], f64::RAY_GROUND, steps};
      segment = up ? segment + 1 : segment - 1;
      ray.segment = &medium_.segments[segment];
      ray.cell = up ? ray.segment->first : ray.segment->last;
      ray(y, slope, 0);
    }
    return {y[2], f64::RAY_LIMIT, most_steps};
  }

  /// Where the step just made passes the edge: secant on the dense output.
  static State land(const Stepper &stepper, const State &y, const State &slope, const State &next,
                    const State &next_slope, double step, double edge_m) {
    const double edge = edge_m / height_unit_m;
    double a = 0, b = step, miss_a = y[0] - edge, miss_b = next[0] - edge;
    State at = next;
    for (int i = 0; i < 20 && std::abs(miss_b) > 1e-10 / height_unit_m; ++i) {
      const double c = b - miss_b * (b - a) / (miss_b - miss_a);
      stepper.calc_state(c, at, y, slope, 0.0, next, next_slope, step);
      a = b, miss_a = miss_b, b = c, miss_b = at[0] - edge;
      if (miss_a == miss_b) break;
    }
    at[0] = edge;
    return at;
  }

  Medium medium_;
  Form form_;
  double tolerance_;
  unsigned threads_;
  std::vector<Start> starts_;
  std::vector<Bent> results_;
};

void add(std::vector<Method> &methods, Form form, StepEnds ends, double table_arcsec, double tolerance,
         unsigned threads) {
  std::ostringstream text;
  text << "odeint dopri5 double " << (form == Form::classical ? "classical" : "flattened") << ", ends at "
       << (ends == StepEnds::knots   ? "knots"
           : ends == StepEnds::kinks ? "kinks"
                                     : "every 4th knot")
       << ", table " << table_arcsec << "\", tolerance " << tolerance;
  methods.push_back({{"Boost.odeint dopri5", BOOST_LIB_VERSION, "dopri5", "double", 1},
                     text.str(),
                     "host, " + std::to_string(threads) + " threads",
                     table_arcsec,
                     tolerance,
                     [=](const IndexTable &table, std::span<const f64::RayStart> starts) {
                       return std::make_unique<OdeintRunner>(table, starts, form, ends, tolerance, threads);
                     }});
}

}  // namespace

std::vector<Method> odeint_methods(unsigned threads, bool few) {
  std::vector<Method> methods;
  if (few) {
    add(methods, Form::classical, StepEnds::knots, 0.01, 1e-7, threads);
    return methods;
  }
  for (const Form form : {Form::classical, Form::flattened}) {
    for (const double tolerance : {1e-5, 3e-6, 1e-6, 5e-7, 2e-7, 1e-7, 1e-8, 1e-9, 1e-11})
      add(methods, form, StepEnds::kinks, 1e-4, tolerance, threads);
    for (const double tolerance : {1e-4, 1e-5, 5e-6, 2e-6, 1e-6, 1e-7})
      add(methods, form, StepEnds::fourth_knots, std::max(1e-3, 1e3 * tolerance), tolerance, threads);
    for (const double tolerance : {1e-4, 1e-5, 3e-6, 1e-6, 1e-7})
      add(methods, form, StepEnds::knots, std::min(3.0, 3e4 * tolerance), tolerance, threads);
  }
  return methods;
}

}  // namespace greenray::bench
