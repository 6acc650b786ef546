#include "render/transfer_curve.hpp"

#include <algorithm>
#include <cmath>

#include "support/angle.hpp"

namespace greenray {
namespace {

constexpr double relative_tolerance = 1e-3;  // of columns and distance
constexpr double narrowest_rad = 2e-9;       // no interval is split further
constexpr int most_levels = 26;

/// One elevation with the rays of all wavelengths.
struct Entry {
  double elevation_rad;
  std::vector<Transfer> rays;
};

struct Interval {
  std::size_t low, high;  // entries
};

/// How badly the middle of an interval is interpolated, in units of what is allowed.
double misfit(const Transfer &a, const Transfer &middle, const Transfer &b, double width_rad, double tolerance_rad) {
  if (a.outcome != middle.outcome || b.outcome != middle.outcome) return 1e9;
  if (middle.outcome == f64::RAY_TRAPPED) return 0;
  const double stretch = std::max(1.0, std::abs(1 - (b.bending_rad - a.bending_rad) / width_rad));
  double worst = std::abs(0.5 * (a.bending_rad + b.bending_rad) - middle.bending_rad) / tolerance_rad;
  const auto relative = [&](double x, double y, double z) {
    if (y > 0) worst = std::max(worst, std::abs(0.5 * (x + z) - y) / (y * relative_tolerance));
  };
  relative(a.distance_m, middle.distance_m, b.distance_m);
  for (std::size_t k = 0; k < a.column.size(); ++k) relative(a.column[k], middle.column[k], b.column[k]);
  return worst / stretch;
}

class CurveTracer {
 public:
  CurveTracer(SkyRays &rays, double tolerance_arcsec)
      : rays_(rays), waves_(rays.wavelengths_nm().size()), tolerance_rad_(from_arcsec(tolerance_arcsec)) {
    for (std::size_t w = 0; w < waves_; ++w)
      breaks_.push_back(rays.varies() ? std::vector<double>{} : breaks_rad(rays.layers(), w));
  }

  TransferCurve trace(double low_rad, double high_rad) {
    const std::vector<double> first = first_elevations(low_rad, high_rad);
    add(first);
    std::vector<Interval> open;
    for (std::size_t i = 0; i + 1 < first.size(); ++i) open.push_back({i, i + 1});
    for (int level = 0; level < most_levels && !open.empty(); ++level) open = refine(open);
    return curve();
  }

 private:
  /// Evenly spaced ones, those that turn at the edges of layers, and both sides of every break.
  std::vector<double> first_elevations(double low_rad, double high_rad) {
    std::vector<double> all;
    if (!rays_.varies()) all = turning_knots_rad(rays_.layers(), 0);
    constexpr int pieces = 64;
    for (int i = 0; i <= pieces; ++i) all.push_back(low_rad + (high_rad - low_rad) * i / pieces);
    std::sort(all.begin(), all.end());
    std::vector<double> chosen;
    for (double e : all)
      if (e >= low_rad && e <= high_rad && (chosen.empty() || e - chosen.back() > 1e-6)) chosen.push_back(e);
    chosen.back() = high_rad;
    for (const std::vector<double> &breaks : breaks_)
      for (double b : breaks)
        for (double side : {-bracket_rad(b), bracket_rad(b)})
          if (b + side > low_rad && b + side < high_rad) chosen.push_back(b + side);
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    return chosen;
  }

  /// As close to a break as the solver's precision can tell the two sides apart.
  double bracket_rad(double break_rad) const {
    return rays_.options().precision == Precision::double_ ? 1e-10 : 1e-9 + 1e-6 * std::abs(break_rad);
  }

  void add(const std::vector<double> &elevations) {
    const std::vector<f64::RayEnd> ends = rays_.trace(elevations);
    rays_traced_ += ends.size();
    for (std::size_t i = 0; i < elevations.size(); ++i) {
      Entry entry{elevations[i], {}};
      for (std::size_t w = 0; w < waves_; ++w)
        entry.rays.push_back(transfer_of(ends[i * waves_ + w], elevations[i], rays_.curvature_per_m()));
      entries_.push_back(std::move(entry));
    }
  }

  bool broken(const Interval &interval, std::size_t wave) const {
    const double low = entries_[interval.low].elevation_rad, high = entries_[interval.high].elevation_rad;
    const auto next = std::lower_bound(breaks_[wave].begin(), breaks_[wave].end(), low);
    return next != breaks_[wave].end() && *next <= high;
  }

  /// Splits the intervals that are not good enough yet; those that are keep their two ends only.
  std::vector<Interval> refine(const std::vector<Interval> &open) {
    std::vector<double> middles;
    for (const Interval &i : open) middles.push_back(0.5 * (elevation(i.low) + elevation(i.high)));
    const std::size_t first = entries_.size();
    add(middles);
    std::vector<Interval> next;
    std::vector<Entry> kept;
    for (std::size_t k = 0; k < open.size(); ++k) {
      const double width = elevation(open[k].high) - elevation(open[k].low);
      double worst = 0;
      for (std::size_t w = 0; w < waves_; ++w)
        if (!broken(open[k], w))
          worst = std::max(worst, misfit(entries_[open[k].low].rays[w], entries_[first + k].rays[w],
                                         entries_[open[k].high].rays[w], width, tolerance_rad_));
      if (worst > 1 && width > narrowest_rad) {
        const std::size_t middle = first + kept.size();
        kept.push_back(std::move(entries_[first + k]));
        next.push_back({open[k].low, middle});
        next.push_back({middle, open[k].high});
      } else if (worst < 1e8) {
        worst_ = std::max(worst_, worst);
      }
    }
    entries_.resize(first);
    std::move(kept.begin(), kept.end(), std::back_inserter(entries_));
    return next;
  }

  /// Where breaks are not known beforehand (air that varies along the surface), halving has closed in on them: a narrow
  /// interval across which the true altitude still leaps.
  bool torn(std::size_t i, std::size_t wave) const {
    if (!rays_.varies()) return false;
    const double width = elevation(i + 1) - elevation(i);
    const double leap = entries_[i + 1].rays[wave].bending_rad - entries_[i].rays[wave].bending_rad;
    return width <= 2 * narrowest_rad && std::abs(leap) > std::max(tolerance_rad_, 1e3 * width);
  }

  double elevation(std::size_t entry) const { return entries_[entry].elevation_rad; }

  TransferCurve curve() {
    std::sort(entries_.begin(), entries_.end(),
              [](const Entry &a, const Entry &b) { return a.elevation_rad < b.elevation_rad; });
    TransferCurve result;
    result.height_m = rays_.options().height_m;
    result.wavelength_nm = rays_.wavelengths_nm();
    result.interpolation_arcsec = to_arcsec(worst_ * tolerance_rad_);
    result.rays_traced = rays_traced_;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      result.elevation_rad.push_back(elevation(i));
      for (std::size_t w = 0; w < waves_; ++w) {
        const bool last = i + 1 == entries_.size();
        result.joined_to_next.push_back(!last && !broken({i, i + 1}, w) && !torn(i, w) &&
                                        entries_[i].rays[w].outcome == entries_[i + 1].rays[w].outcome);
        result.rays.push_back(entries_[i].rays[w]);
      }
    }
    return result;
  }

  SkyRays &rays_;
  std::size_t waves_;
  double tolerance_rad_;
  std::vector<std::vector<double>> breaks_;
  std::vector<Entry> entries_;
  double worst_ = 0;
  std::size_t rays_traced_ = 0;
};

Transfer between(const Transfer &a, const Transfer &b, double f) {
  const auto mix = [f](double x, double y) { return x + f * (y - x); };
  Transfer t = f < 0.5 ? a : b;
  t.true_altitude_rad = mix(a.true_altitude_rad, b.true_altitude_rad);
  t.bending_rad = mix(a.bending_rad, b.bending_rad);
  for (std::size_t k = 0; k < t.column.size(); ++k) t.column[k] = mix(a.column[k], b.column[k]);
  t.distance_m = mix(a.distance_m, b.distance_m);
  t.min_height_m = mix(a.min_height_m, b.min_height_m);
  return t;
}

}  // namespace

TransferCurve trace_transfer_curve(SkyRays &rays, double low_rad, double high_rad, double tolerance_arcsec) {
  return CurveTracer(rays, tolerance_arcsec).trace(low_rad, high_rad);
}

std::vector<Image> images_of(const TransferCurve &curve, std::size_t wave, double true_altitude_rad) {
  std::vector<Image> images;
  for (std::size_t i = 0; i + 1 < curve.elevation_rad.size(); ++i) {
    const Transfer &a = curve.at(i, wave), &b = curve.at(i + 1, wave);
    if (!curve.joined(i, wave) || a.outcome != f64::RAY_SPACE) continue;
    const double from = a.true_altitude_rad, to = b.true_altitude_rad;
    if ((from <= true_altitude_rad) == (to <= true_altitude_rad)) continue;
    const double width = curve.elevation_rad[i + 1] - curve.elevation_rad[i];
    const double seen = curve.elevation_rad[i] + width * (true_altitude_rad - from) / (to - from);
    images.push_back({to_deg(seen), to > from, width / std::abs(to - from)});
  }
  return images;
}

TransferTable evenly_spaced(const TransferCurve &curve, double first_rad, double spacing_rad, std::size_t entries) {
  TransferTable table;
  table.first_elevation_rad = first_rad;
  table.spacing_rad = spacing_rad;
  table.entries = entries;
  table.wavelengths = curve.wavelength_nm.size();
  table.rays.reserve(entries * table.wavelengths);
  table.edges.assign(entries * table.wavelengths, 1.0f);
  std::size_t i = 0;
  for (std::size_t e = 0; e < entries; ++e) {
    const double wanted = table.elevation_rad(e);
    while (i + 2 < curve.elevation_rad.size() && curve.elevation_rad[i + 1] <= wanted) ++i;
    const double low = curve.elevation_rad[i], high = curve.elevation_rad[i + 1];
    const double f = std::clamp((wanted - low) / (high - low), 0.0, 1.0);
    for (std::size_t w = 0; w < table.wavelengths; ++w)
      table.rays.push_back(curve.joined(i, w) ? between(curve.at(i, w), curve.at(i + 1, w), f)
                                              : curve.at(f < 0.5 ? i : i + 1, w));
  }
  for (std::size_t k = 0; k + 1 < curve.elevation_rad.size(); ++k) {
    const double at = (0.5 * (curve.elevation_rad[k] + curve.elevation_rad[k + 1]) - first_rad) / spacing_rad;
    if (at < 0 || at >= static_cast<double>(entries - 1)) continue;
    const auto e = static_cast<std::size_t>(at);
    for (std::size_t w = 0; w < table.wavelengths; ++w)
      if (!curve.joined(k, w))
        table.edges[e * table.wavelengths + w] = static_cast<float>(std::min(at - static_cast<double>(e), 0.999));
  }
  return table;
}

}  // namespace greenray
