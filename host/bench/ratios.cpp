#include "bench/ratios.hpp"

#include <algorithm>
#include <functional>
#include <iomanip>
#include <sstream>
#include <tuple>

namespace greenray::bench {
namespace {

using Wanted = std::function<bool(const Record &)>;

Wanted ours(const std::string &solver, const std::string &precision = "", int lanes = 0) {
  return [=](const Record &r) {
    return r.ours() && r.kind.solver == solver && (precision.empty() || r.kind.precision == precision) &&
           (lanes == 0 || r.kind.lanes == lanes);
  };
}
Wanted by(const std::string &peer) {
  return [=](const Record &r) { return r.kind.by == peer; };
}
bool steps(const Record &r) { return r.ours() && (r.kind.solver == "rk45" || r.kind.solver == "richardson"); }
bool closed_form(const Record &r) { return r.ours() && r.kind.solver == "closed form"; }

class Ratios {
 public:
  explicit Ratios(const Results &results) : results_(results) {
    const auto type = results.about.find("device_type");
    device_is_cpu_ = type == results.about.end() || type->second == "cpu";
  }

  std::vector<Ratio> all() {
    for (const char *name : {"us76", "thin-5K", "ten-inversions"}) rays(name), ways_of_compiling(name);
    ten_inversions();
    against_pal();
    growth();
    pictures();
    rooms();
    return std::move(rows_);
  }

 private:
  double speed(const Record &r, Basis basis) const {
    if (basis == Basis::kernel) return r.number("kernel_rate", r.rate);
    const bool by_cpu = device_is_cpu_ && basis != Basis::wall && r.cpu_seconds > 0;
    return by_cpu ? r.rate * r.wall_seconds / r.cpu_seconds : r.rate;
  }
  Basis basis() const { return device_is_cpu_ ? Basis::cpu : Basis::wall; }

  bool has(const std::string &case_name) const {
    return std::any_of(results_.records.begin(), results_.records.end(),
                       [&](const Record &r) { return r.case_name == case_name; });
  }

  const Record *fastest(const std::string &case_name, const Wanted &wanted, double most_error) const {
    const Record *best = nullptr;
    for (const Record &r : results_.records)
      if (r.case_name == case_name && wanted(r) && r.number("wrong_outcomes") == 0 && r.error <= most_error &&
          (!best || speed(r, basis()) > speed(*best, basis())))
        best = &r;
    return best;
  }

  /// The row of two records; without one of them, of what is missing.
  Ratio row(const std::string &what, const std::string &case_name, const Record *a, const Record *b, Basis basis,
            double floor, double aim) const {
    Ratio ratio{what, case_name, 0, basis, floor, aim, "", "", 0, 0, "arcsec", ""};
    if (a) ratio.ours = a->variant, ratio.our_error = a->error, ratio.error_unit = a->error_unit;
    if (b) ratio.theirs = b->variant, ratio.their_error = b->error, ratio.error_unit = b->error_unit;
    if (a && b)
      ratio.value = basis == Basis::cost ? speed(*b, basis) / speed(*a, basis) : speed(*a, basis) / speed(*b, basis);
    else ratio.note = b ? "no setting of ours is as accurate" : "no setting of the peer is as accurate";
    return ratio;
  }

  /// At a level of error; see ratios_of.
  void at_level(const std::string &what, const std::string &case_name, const Wanted &mine, const Wanted &peers,
                double error, double floor, double aim) {
    const auto present = [&](const Record &r) { return r.case_name == case_name && peers(r); };
    if (std::none_of(results_.records.begin(), results_.records.end(), present)) return;
    const Record *peer = fastest(case_name, peers, error);
    const Record *own = peer ? fastest(case_name, mine, peer->error) : nullptr;
    rows_.push_back(row(what, case_name, own, peer, basis(), floor, aim));
  }

  void rays(const std::string &case_name) {
    const bool asked = case_name != "ten-inversions";
    const Wanted tuned = by("Boost.odeint dopri5"), untuned = by("Boost.odeint dopri5, untuned");
    for (const auto &[error, words, floor, aim] :
         {std::tuple(0.01, "0.01″", 150.0, 500.0), std::tuple(0.003, "0.003″", 100.0, 300.0)}) {
      const std::string at = std::string(" at ") + words;
      at_level("closed form / odeint dopri5 tuned" + at, case_name, closed_form, tuned, error, asked ? floor : 0,
               asked ? aim : 0);
      at_level("closed form / odeint dopri5 untuned" + at, case_name, closed_form, untuned, error, asked ? floor : 0,
               asked ? aim : 0);
    }
    at_level("closed form / own best ODE kernel at 0.01″", case_name, closed_form, steps, 0.01, 15, 40);
  }

  void against_pal() {
    if (!has("pal-air")) return;
    const Record *peer = nullptr;
    for (const Record &r : results_.records)
      if (r.kind.by == "PAL palRefro" && r.variant.find("tolerance 1e-06") != std::string::npos) peer = &r;
    if (!peer) return;
    const Record *own = fastest("pal-air", closed_form, peer->error);
    rows_.push_back(row("closed form / palRefro at its 1e-6", "pal-air", own, peer, basis(), 50, 150));
  }

  /// The same setting, compiled in two ways.
  void pair(const std::string &what, const std::string &case_name, const Wanted &mine, const Wanted &other,
            const std::string &setting, Basis basis, double floor, double aim) {
    const auto with_setting = [&](const Wanted &wanted) {
      return [&](const Record &r) { return wanted(r) && r.variant.find(setting) != std::string::npos; };
    };
    const Record *a = fastest(case_name, with_setting(mine), 1e9), *b = fastest(case_name, with_setting(other), 1e9);
    if (a && b) rows_.push_back(row(what, case_name, a, b, basis, floor, aim));
  }

  void ways_of_compiling(const std::string &case_name) {
    const std::string step = "table 0.01\", step 3e-08", layer = "layers 0.01\"";
    const auto native = [](const std::string &solver) {
      return [=](const Record &r) { return r.kind.by == "native C++" && r.kind.solver == solver && r.kind.lanes == 8; };
    };
    pair("8 lanes / 1 lane, ODE kernel", case_name, ours("rk45", "float", 8), ours("rk45", "float", 1), step, basis(),
         4, 6);
    pair("8 lanes / 1 lane, closed form", case_name, ours("closed form", "float", 8), ours("closed form", "float", 1),
         layer, Basis::kernel, 0, 0);
    pair("OpenCL 8 lanes / the same text as C++, ODE", case_name, ours("rk45", "float", 8), native("rk45"), step,
         Basis::kernel, 0.6, 0.9);
    pair("OpenCL 8 lanes / the same text as C++, closed form", case_name, ours("closed form", "float", 8),
         native("closed form"), layer, Basis::kernel, 0.6, 0.9);
  }

  /// The transfer table against rays of each pixel's own at one sample, each size of the picture. The bar was set for
  /// rays by steps; in closed form they cost a hundredth, so that little is left for a table to save.
  void pictures() {
    std::vector<std::string> sizes;
    for (const Record &r : results_.records)
      if (r.suite == "images" && std::find(sizes.begin(), sizes.end(), r.case_name) == sizes.end())
        sizes.push_back(r.case_name);
    for (const std::string &size : sizes) {
      const bool asked = size == "sun-1920x1080";
      pair("transfer table / per-pixel tracing by steps", size, ours("transfer table"), ours("per pixel, steps"),
           ", 1 sample a pixel", Basis::wall, asked ? 50 : 0, asked ? 200 : 0);
      pair("transfer table / per-pixel tracing in closed form", size, ours("transfer table"), ours("per pixel"),
           ", 1 sample a pixel", Basis::wall, 0, 0);
    }
  }

  /// What a photon of the cross room costs in one way over another.
  void rooms() {
    const auto found = [&](const char *variant) -> const Record * {
      for (const Record &r : results_.records)
        if (r.suite == "geometry" && r.case_name == "cross-room" && r.variant == variant) return &r;
      return nullptr;
    };
    for (const auto &[what, dear, cheap, floor, aim] :
         {std::tuple("cost of a photon, curved / straight", "curved", "straight", 2.5, 1.5),
          {"cost of a photon, 16 times the photons", "curved", "curved, a sixteenth of the photons", 1.3, 0.0},
          {"cost of a photon, 16 times the triangles", "curved, 16 times as many triangles", "curved, many triangles",
           2.0, 0.0}}) {
      const Record *a = found(dear), *b = found(cheap);
      if (a && b) rows_.push_back(row(what, "cross-room", a, b, Basis::cost, floor, aim));
    }
  }

  void ten_inversions() {
    for (const auto &[what, wanted] : watched) {
      const Record *smooth = fastest("us76", wanted, 0.01), *thin = fastest("ten-inversions", wanted, 0.01);
      if (!smooth || !thin) continue;
      rows_.push_back(row("cost of ten thin inversions / smooth air, " + what, "ten-inversions", thin, smooth,
                          Basis::cost, what == "ODE" ? 0 : 2, 0));  // asked of what the planner takes
      rows_.back().note = "cost, CPU time, both at 0.01″";
    }
  }

  void growth() {
    cores();
    evenness("cost of a ray, most rays / a quarter of them", "rays");
    evenness("cost of a ray, most wavelengths / half of them", "wavelengths");
  }

  /// A method's records of a case, by what is varied.
  std::vector<const Record *> along(const std::string &varied, const std::string &case_name,
                                    const Wanted &wanted) const {
    std::vector<const Record *> curve;
    for (const Record &r : results_.records)
      if (r.case_name == case_name && wanted(r)) curve.push_back(&r);
    std::sort(curve.begin(), curve.end(),
              [&](const Record *a, const Record *b) { return a->number(varied) < b->number(varied); });
    return curve;
  }

  void cores() {
    for (const auto &[solver, wanted] : watched) {
      const auto curve = along("threads", "cores", wanted);
      if (curve.size() < 2) continue;
      const bool two_against_one = curve.front()->number("threads") == 1 && curve.back()->number("threads") == 2;
      rows_.push_back(row("all cores / fewest, " + solver, "cores", curve.back(), curve.front(), Basis::wall,
                          two_against_one ? 1.8 : 0, 0));
    }
  }

  /// The last two points: with fewer the cost of the call itself counts.
  void evenness(const std::string &what, const std::string &case_name) {
    for (const auto &[solver, wanted] : watched) {
      const auto curve = along(case_name, case_name, wanted);
      if (curve.size() < 2) continue;
      rows_.push_back(row(what + ", " + solver, case_name, curve.back(), curve[curve.size() - 2], Basis::cost, 0, 0));
    }
  }

  const std::vector<std::pair<std::string, Wanted>> watched{{"closed form", closed_form}, {"ODE", steps}};
  const Results &results_;
  bool device_is_cpu_;
  std::vector<Ratio> rows_;
};

}  // namespace

std::string Ratio::verdict() const {
  if (!measured() || (floor <= 0 && aim <= 0)) return "";
  if (basis == Basis::cost) return value <= aim ? "aim" : value <= floor ? "floor" : "missed";
  if (aim > 0 && value >= aim) return "aim";
  return value >= floor ? "floor" : "missed";
}

const char *basis_words(Basis basis) {
  switch (basis) {
    case Basis::cpu:
      return "CPU time";
    case Basis::wall:
      return "wall time";
    case Basis::kernel:
      return "kernel, wall time";
    case Basis::cost:
      return "cost, CPU time";
  }
  return "";
}

std::string text_of(const std::vector<Ratio> &ratios) {
  std::ostringstream text;
  for (const Ratio &r : ratios) {
    text << std::left << std::setw(16) << r.case_name << std::setw(58) << r.what << std::right << std::setprecision(3);
    if (!r.measured()) text << "       -  " << r.note << "\n";
    else {
      text << std::setw(8) << r.value << " x  " << basis_words(r.basis);
      if (r.floor > 0) text << (r.basis == Basis::cost ? ", at most " : ", floor ") << r.floor;
      if (r.aim > 0) text << ", aim " << r.aim;
      text << (r.verdict().empty() ? "" : ": ") << r.verdict() << "\n";
    }
  }
  return text.str();
}

std::vector<Ratio> ratios_of(const Results &results) { return Ratios(results).all(); }

}  // namespace greenray::bench
