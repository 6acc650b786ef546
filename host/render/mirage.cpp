#include "render/mirage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "atmosphere/diagnosis.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

constexpr double bottomless = -std::numeric_limits<double>::infinity();
constexpr double clear_of_edge_rad = 3e-8;  // nearer to a smooth duct's edge the layers' closed form saturates
constexpr double same_rad = 1e-8;           // a leap of less is none
constexpr double sliver_rad = 2e-9;         // no piece of its own

/// A point of the curve.
struct Point {
  double apparent_rad, true_rad;
};

/// Points joined by one ray's smooth change.
struct Piece {
  std::vector<Point> points;
  BranchEnd low_end, high_end;
  bool bottomless_low = false, bottomless_high = false;
};

/// Modified index ln n + ln(1 + h/R) at any wavelength.
double modified(const Profile &air, double height_m, double wavelength_nm) {
  return std::log1p(air.refractivity(height_m, wavelength_nm).value) + std::log1p(height_m / air.spec().earth_radius_m);
}

/// Elevations [rad, >= 0] of the rays that become level at the top of a duct where M is smooth: they never leave it.
std::vector<double> endless_rad(const Profile &air, double eye_m, double wavelength_nm) {
  std::vector<double> found;
  for (const Duct &duct : diagnose(air).ducts) {
    const double below = ray_curvature(air, duct.top_m * (1 - 1e-9)),
                 above = ray_curvature(air, duct.top_m * (1 + 1e-9));
    if (std::abs(below - above) > 1e-3) continue;  // a kink: rays cross it in finite distance
    const double lift = 2 * (modified(air, eye_m, wavelength_nm) - modified(air, duct.top_m, wavelength_nm));
    if (lift >= 0) found.push_back(std::atan(std::sqrt(std::expm1(lift))));
  }
  return found;
}

class MirageFinder {
 public:
  MirageFinder(SkyRays &rays, const Profile &air, const MirageOptions &options)
      : rays_(rays), air_(air), options_(options), curve_(trace()) {}

  Mirages of(std::size_t wave) {
    Mirages m;
    m.wavelength_nm = curve_.wavelength_nm[wave];
    m.least_fold_arcsec = options_.least_fold_arcsec;
    if (!rays_.varies() && !rays_.options().flat)
      endless_ = endless_rad(air_, rays_.options().height_m, m.wavelength_nm);
    find_fates(wave, m);
    for (Piece &piece : pieces(wave)) {
      refine_extremes(piece, wave);
      add(piece, m);
    }
    number(m);
    count(m);
    return m;
  }

 private:
  TransferCurve trace() {
    double low = to_rad(-5), high = to_rad(3);
    const double below_air_rad = std::acos(1 / (1 + std::max(0.0, rays_.options().height_m) * rays_.curvature_per_m()));
    low = std::min(low, -below_air_rad - to_rad(1));
    if (!rays_.varies())
      for (std::size_t w = 0; w < rays_.wavelengths_nm().size(); ++w) {
        const std::vector<double> breaks = breaks_rad(rays_.layers(), w);
        if (breaks.empty()) continue;
        low = w == 0 ? breaks.front() : std::min(low, breaks.front());
        high = std::max(high, breaks.back() + to_rad(1));
      }
    low -= to_rad(0.02);
    return trace_transfer_curve(rays_, std::max(low, -pi / 2), std::min(high, pi / 2), options_.tolerance_arcsec,
                                options_.narrowest_rad);
  }

  double true_rad(std::size_t entry, std::size_t wave) const {
    return curve_.elevation_rad[entry] - curve_.at(entry, wave).bending_rad;
  }

  void find_fates(std::size_t wave, Mirages &m) const {
    double from = -90;
    for (std::size_t i = 0; i + 1 < curve_.elevation_rad.size(); ++i) {
      const int here = curve_.at(i, wave).outcome, next = curve_.at(i + 1, wave).outcome;
      if (here == next) continue;
      const double edge = to_deg(0.5 * (curve_.elevation_rad[i] + curve_.elevation_rad[i + 1]));
      m.fates.push_back({from, edge, here});
      from = edge;
    }
    m.fates.push_back({from, 90, curve_.at(curve_.elevation_rad.size() - 1, wave).outcome});
  }

  BranchEnd end_at(int beyond) const {
    return beyond == f64::RAY_GROUND    ? BranchEnd::horizon
           : beyond == f64::RAY_TRAPPED ? BranchEnd::duct_edge
                                        : BranchEnd::limit;
  }

  bool is_endless(double apparent_rad) const {
    return std::any_of(endless_.begin(), endless_.end(),
                       [&](double e) { return std::abs(std::abs(apparent_rad) - e) < 1e-7 + 1e-4 * e; });
  }

  /// Runs of entries to space, each joined to the next.
  std::vector<Piece> pieces(std::size_t wave) const {
    std::vector<Piece> found;
    bool open = false;
    for (std::size_t i = 0; i < curve_.elevation_rad.size(); ++i) {
      const int outcome = curve_.at(i, wave).outcome;
      if (outcome != f64::RAY_SPACE) {
        if (open) close(found.back(), end_at(outcome));
        open = false;
        continue;
      }
      const Point point{curve_.elevation_rad[i], true_rad(i, wave)};
      if (open && !curve_.joined(i - 1, wave) &&
          std::abs(point.true_rad - found.back().points.back().true_rad) > same_rad)
        close(found.back(), BranchEnd::jump), open = false;
      if (!open) {
        const bool first = i == 0, leapt = !first && curve_.at(i - 1, wave).outcome == f64::RAY_SPACE;
        found.push_back({{},
                         first   ? BranchEnd::limit
                         : leapt ? BranchEnd::jump
                                 : end_at(curve_.at(i - 1, wave).outcome),
                         BranchEnd::limit,
                         false,
                         false});
        open = true;
      }
      found.back().points.push_back(point);
    }
    if (open) close(found.back(), BranchEnd::zenith);
    drop_slivers(found);
    for (Piece &piece : found) mark_endless(piece);
    std::erase_if(found, [](const Piece &piece) { return piece.points.size() < 2; });
    return found;
  }

  /// Two breaks in one place leave a piece without width between them, whose outer ends are those of its neighbours.
  static void drop_slivers(std::vector<Piece> &found) {
    const auto is_sliver = [](const Piece &piece) {
      return piece.points.size() < 2 ||
             piece.points.back().apparent_rad - piece.points.front().apparent_rad < sliver_rad;
    };
    for (std::size_t i = 0; i < found.size();) {
      if (!is_sliver(found[i])) {
        ++i;
        continue;
      }
      if (i > 0 && found[i - 1].high_end == BranchEnd::jump) found[i - 1].high_end = found[i].high_end;
      if (i + 1 < found.size() && found[i + 1].low_end == BranchEnd::jump) found[i + 1].low_end = found[i].low_end;
      found.erase(found.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }

  static void close(Piece &piece, BranchEnd end) { piece.high_end = end; }

  /// Entries too near to the edge of a smooth duct are left out; the end itself lies infinitely low.
  void mark_endless(Piece &piece) const {
    std::vector<Point> &p = piece.points;
    const double low = p.front().apparent_rad, high = p.back().apparent_rad;
    const auto leaves = [](BranchEnd end) {
      return end == BranchEnd::duct_edge || end == BranchEnd::jump || end == BranchEnd::horizon;
    };
    piece.bottomless_low = leaves(piece.low_end) && is_endless(low);
    piece.bottomless_high = leaves(piece.high_end) && is_endless(high);
    if (piece.bottomless_low) {
      piece.low_end = BranchEnd::duct_edge;
      std::erase_if(p, [&](const Point &q) { return q.apparent_rad < low + clear_of_edge_rad; });
    }
    if (piece.bottomless_high) {
      piece.high_end = BranchEnd::duct_edge;
      std::erase_if(p, [&](const Point &q) { return q.apparent_rad > high - clear_of_edge_rad; });
    }
    if (piece.bottomless_low) p.insert(p.begin(), {low, bottomless});
    if (piece.bottomless_high) p.push_back({high, bottomless});
  }

  static bool is_extreme(const std::vector<Point> &p, std::size_t i) {
    const double before = p[i].true_rad - p[i - 1].true_rad, after = p[i + 1].true_rad - p[i].true_rad;
    return before * after < 0 ||
           (before != 0 && after == 0 && i + 2 < p.size() && (p[i + 2].true_rad - p[i].true_rad) * before < 0);
  }

  /// Moves the points at extremes onto them: nine rays across the two intervals beside each, all extremes at a time.
  void refine_extremes(Piece &piece, std::size_t wave) {
    std::vector<Point> &p = piece.points;
    struct Bracket {
      std::size_t at;
      double low, high;
      bool highest;
    };
    std::vector<Bracket> brackets;
    for (std::size_t i = 1; i + 1 < p.size(); ++i)
      if (is_extreme(p, i))
        brackets.push_back({i, p[i - 1].apparent_rad, p[i + 1].apparent_rad, p[i].true_rad > p[i - 1].true_rad});
    constexpr int rounds = 9, across = 8;
    for (int round = 0; round < rounds && !brackets.empty(); ++round) {
      std::vector<double> elevations;
      for (const Bracket &b : brackets)
        for (int k = 0; k <= across; ++k) elevations.push_back(b.low + (b.high - b.low) * k / across);
      const std::vector<f64::RayEnd> ends = rays_.trace(elevations);
      for (std::size_t b = 0; b < brackets.size(); ++b) {
        int best = -1;
        for (int k = 1; k < across; ++k) {
          const std::size_t ray = b * (across + 1) + static_cast<std::size_t>(k);
          const f64::RayEnd &end = ends[ray * curve_.wavelength_nm.size() + wave];
          if (end.outcome != f64::RAY_SPACE) continue;
          const double altitude = elevations[ray] - end.bending_rad;
          Point &kept = p[brackets[b].at];
          if (best >= 0 && !(brackets[b].highest ? altitude > kept.true_rad : altitude < kept.true_rad)) continue;
          best = k;
          kept = {elevations[ray], altitude};
        }
        if (best < 0) continue;
        const double low = brackets[b].low, step = (brackets[b].high - low) / across;
        brackets[b].low = low + step * (best - 1), brackets[b].high = low + step * (best + 1);
      }
    }
  }

  /// Ends and extremes in turn, without pairs that differ by less than the least fold.
  std::vector<std::size_t> turning_points(const std::vector<Point> &p) const {
    std::vector<std::size_t> kept{0};
    for (std::size_t i = 1; i + 1 < p.size(); ++i)
      if (is_extreme(p, i)) kept.push_back(i);
    kept.push_back(p.size() - 1);
    const double least = from_arcsec(options_.least_fold_arcsec);
    while (kept.size() > 2) {
      std::size_t weakest = 0;
      double difference = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k + 1 < kept.size(); ++k) {
        const double d = std::abs(p[kept[k]].true_rad - p[kept[k + 1]].true_rad);
        if (d < difference) difference = d, weakest = k;
      }
      if (!(difference < least)) break;
      const auto at = kept.begin() + static_cast<std::ptrdiff_t>(weakest);
      if (weakest == 0) kept.erase(at + 1);
      else if (weakest + 2 == kept.size()) kept.erase(at);
      else kept.erase(at, at + 2);
    }
    return kept;
  }

  void add(const Piece &piece, Mirages &m) const {
    const std::vector<Point> &p = piece.points;
    const std::vector<std::size_t> turns = turning_points(p);
    const bool to_zenith = piece.high_end == BranchEnd::zenith;
    for (std::size_t k = 0; k + 1 < turns.size(); ++k) {
      const Point &low = p[turns[k]], &high = p[turns[k + 1]];
      const bool first = k == 0, last = k + 2 == turns.size();
      Branch branch{0,
                    to_deg(low.apparent_rad),
                    to_deg(high.apparent_rad),
                    to_deg(low.true_rad),
                    to_deg(high.true_rad),
                    high.true_rad > low.true_rad,
                    first ? piece.low_end : BranchEnd::fold,
                    last ? piece.high_end : BranchEnd::fold};
      if (last && to_zenith) branch.high_deg = branch.true_at_high_deg = 90;
      m.branches.push_back(branch);
      if (!last) m.folds.push_back({0, branch.high_deg, branch.true_at_high_deg, branch.erect});
    }
    if (!m.apparent_deg.empty()) append(m, std::nan(""), std::nan(""));
    thin(p, m);
  }

  static void append(Mirages &m, double apparent, double true_altitude) {
    m.apparent_deg.push_back(apparent), m.true_deg.push_back(true_altitude);
  }

  /// Points that a plot of some 1000 pixels can tell apart, extremes always.
  static void thin(const std::vector<Point> &p, Mirages &m) {
    constexpr double apart_deg = 3e-4;
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (!std::isfinite(p[i].true_rad)) continue;
      const double apparent = to_deg(p[i].apparent_rad), altitude = to_deg(p[i].true_rad);
      const bool kept = i == 0 || i + 1 == p.size() || is_extreme(p, i) || m.apparent_deg.empty() ||
                        !std::isfinite(m.apparent_deg.back()) || apparent - m.apparent_deg.back() > apart_deg ||
                        std::abs(altitude - m.true_deg.back()) > apart_deg;
      if (kept) append(m, apparent, altitude);
    }
  }

  static void number(Mirages &m) {
    for (std::size_t i = 0; i < m.branches.size(); ++i) m.branches[i].number = static_cast<int>(i) + 1;
    for (std::size_t i = 0; i < m.folds.size(); ++i) m.folds[i].number = static_cast<int>(i) + 1;
  }

  /// The true altitudes at which the number of images changes are the ends of branches.
  static void count(Mirages &m) {
    std::vector<double> ends;
    for (const Branch &b : m.branches) ends.insert(ends.end(), {b.lowest_true_deg(), b.highest_true_deg()});
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const double middle = std::isfinite(ends[i]) ? 0.5 * (ends[i] + ends[i + 1]) : ends[i + 1] - 1;
      const int images = m.images_of(middle);
      m.most_images = std::max(m.most_images, images);
      if (!m.counts.empty() && m.counts.back().images == images) m.counts.back().high_true_deg = ends[i + 1];
      else m.counts.push_back({ends[i], ends[i + 1], images});
    }
  }

  SkyRays &rays_;
  const Profile &air_;
  MirageOptions options_;
  TransferCurve curve_;
  std::vector<double> endless_;
};

}  // namespace

const char *branch_end_name(BranchEnd end) {
  constexpr const char *names[]{"fold", "horizon", "duct-edge", "jump", "zenith", "limit"};
  return names[static_cast<std::size_t>(end)];
}

const Branch *Mirages::branch_at(double altitude_deg) const {
  for (const Branch &b : branches)
    if (altitude_deg >= b.low_deg && altitude_deg <= b.high_deg) return &b;
  return nullptr;
}

int Mirages::images_of(double true_altitude_deg) const {
  return static_cast<int>(std::count_if(branches.begin(), branches.end(), [&](const Branch &b) {
    return true_altitude_deg >= b.lowest_true_deg() && true_altitude_deg < b.highest_true_deg();
  }));
}

std::vector<Mirages> find_mirages(SkyRays &rays, const Profile &air, const MirageOptions &options) {
  MirageFinder finder(rays, air, options);
  std::vector<Mirages> all;
  for (std::size_t wave = 0; wave < rays.wavelengths_nm().size(); ++wave) all.push_back(finder.of(wave));
  return all;
}

}  // namespace greenray
