#include "atmosphere/diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "atmosphere/mirage_words.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

constexpr double least_rise_K_m = 1e-7;  // less is rounding of an isothermal layer
constexpr double least_rise_K = 0.01;    // weaker inversions bend nothing and are not worth a line
constexpr double least_drop = 1e-11;     // of M or ln n: turns a ray by one arc-second
constexpr double kink_side = 1e-12;      // relative step to a kink's lower or upper side
constexpr int deepest_halving = 5;

/// The profile at one height.
struct Sample {
  double height_m;
  double temperature_K, lapse_K_m;  // 0 for a medium given by its index
  double log_index, log_index_slope;
  double radius_m;  // R + h
  double curvature() const { return -radius_m * log_index_slope; }
};

Sample sample_at(const Profile &profile, double height_m) {
  const Dual refractivity = profile.refractivity(height_m, diagnosis_wavelength_nm);
  Sample s{height_m,
           0,
           0,
           std::log1p(refractivity.value),
           refractivity.slope / (1 + refractivity.value),
           profile.spec().earth_radius_m + height_m};
  if (profile.is_air()) {
    const Dual t = profile.air(height_m).temperature_K;
    s.temperature_K = t.value, s.lapse_K_m = t.slope;
  }
  return s;
}

/// A positive value means: inside a layer of this kind.
using Measure = std::function<double(const Sample &)>;
const Measure traps = [](const Sample &s) { return s.curvature() - 1; };
const Measure warms = [](const Sample &s) { return s.lapse_K_m - least_rise_K_m; };
const Measure bends_up = [](const Sample &s) { return s.log_index_slope - 1e-15; };

/* Samples from the ground to the top of the air, in pieces that end at kinks (where slopes jump, each side has its own
   sample). Known features and a net that is fine near the ground give the first samples; a stretch is halved while one
   of the measures might change sign inside it. */
class Scan {
 public:
  explicit Scan(const Profile &profile) : profile_(profile) {
    const std::vector<double> edges = first_edges();
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
      const double a = edges[i], b = edges[i + 1];
      if (!(b - a > 4 * kink_side * b)) continue;
      const Sample low = sample_at(profile_, a * (1 + kink_side)), high = sample_at(profile_, b * (1 - kink_side));
      samples_.push_back(low);
      refine(low, high, 0);
      samples_.push_back(high);
    }
  }

  const std::vector<Sample> &samples() const { return samples_; }

  struct Range {
    double bottom_m, top_m;
    std::size_t first, last;  // samples inside
  };

  /// Ranges with a positive measure; edges by bisection.
  std::vector<Range> ranges(const Measure &measure) const {
    std::vector<Range> found;
    bool inside = false;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const bool positive = measure(samples_[i]) > 0;
      if (positive && !inside) found.push_back({i == 0 ? 0.0 : edge(measure, i - 1), samples_[i].height_m, i, i});
      if (!positive && inside) found.back().top_m = edge(measure, i - 1);
      if (positive) {
        found.back().last = i;
        found.back().top_m = samples_[i].height_m;
      }
      inside = positive;
    }
    return found;
  }

 private:
  std::vector<double> first_edges() const {
    const double top_m = profile_.top_m(!profile_.is_air());
    std::vector<double> edges{0.0, top_m};
    for (double h = 1e-3; h < 500; h *= 1.25) edges.push_back(h);
    for (double h = 500; h < 12000; h += 50) edges.push_back(h);
    for (double h = 12000; h < 120000; h += 1000) edges.push_back(h);
    edges.insert(edges.end(), profile_.kinks_m().begin(), profile_.kinks_m().end());
    edges.insert(edges.end(), profile_.features_m().begin(), profile_.features_m().end());
    std::erase_if(edges, [&](double h) { return h > top_m; });
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
  }

  static bool may_change_sign(const Measure &measure, const Sample &a, const Sample &b, const Sample &c) {
    const auto [low, high] = std::minmax({measure(a), measure(b), measure(c)});
    const double spread = high - low;
    return low - 2 * spread < 0 && high + 2 * spread > 0;
  }

  void refine(const Sample &a, const Sample &b, int depth) {
    const Sample middle = sample_at(profile_, 0.5 * (a.height_m + b.height_m));
    const bool halve =
        depth < deepest_halving && (may_change_sign(traps, a, middle, b) || may_change_sign(warms, a, middle, b) ||
                                    may_change_sign(bends_up, a, middle, b));
    if (halve) refine(a, middle, depth + 1);
    samples_.push_back(middle);
    if (halve) refine(middle, b, depth + 1);
  }

  /// Where the measure changes sign between samples i and i + 1.
  double edge(const Measure &measure, std::size_t i) const {
    double a = samples_[i].height_m, b = samples_[i + 1].height_m;
    const bool positive = measure(samples_[i]) > 0;
    while (b - a > std::max(1e-9, 1e-12 * b)) {
      const double middle = 0.5 * (a + b);
      ((measure(sample_at(profile_, middle)) > 0) == positive ? a : b) = middle;
    }
    return 0.5 * (a + b);
  }

  const Profile &profile_;
  std::vector<Sample> samples_;
};

/// Height below the trapping layer where M is as small as at its top; 0 if it is larger down to the ground.
double duct_bottom(const Profile &profile, const Scan &scan, const Scan::Range &range) {
  const double wanted = modified_index(profile, range.top_m);
  double above_m = range.bottom_m;
  for (std::size_t i = range.first; i-- > 0;) {
    double a = scan.samples()[i].height_m, b = above_m;
    if (a >= b) continue;
    if (modified_index(profile, a) <= wanted) {
      while (b - a > std::max(1e-9, 1e-12 * b)) {
        const double middle = 0.5 * (a + b);
        (modified_index(profile, middle) <= wanted ? a : b) = middle;
      }
      return 0.5 * (a + b);
    }
    above_m = a;
  }
  return 0;
}

std::vector<Duct> find_ducts(const Profile &profile, const Scan &scan) {
  std::vector<Duct> ducts;
  for (const Scan::Range &range : scan.ranges(traps)) {
    const double drop = modified_index(profile, range.bottom_m) - modified_index(profile, range.top_m);
    if (drop < least_drop) continue;
    ducts.push_back(
        {duct_bottom(profile, scan, range), range.bottom_m, range.top_m, drop, to_deg(std::acos(std::exp(-drop)))});
  }
  return ducts;
}

std::vector<Inversion> find_inversions(const Profile &profile, const Scan &scan) {
  std::vector<Inversion> inversions;
  if (!profile.is_air()) return inversions;
  for (const Scan::Range &range : scan.ranges(warms)) {
    Inversion v{range.bottom_m, range.top_m,
                profile.air(range.top_m).temperature_K.value - profile.air(range.bottom_m).temperature_K.value, 0,
                -1e9};
    for (std::size_t i = range.first; i <= range.last; ++i) {
      v.steepest_K_m = std::max(v.steepest_K_m, scan.samples()[i].lapse_K_m);
      v.largest_curvature = std::max(v.largest_curvature, scan.samples()[i].curvature());
    }
    if (v.rise_K >= least_rise_K) inversions.push_back(v);
  }
  return inversions;
}

std::vector<SuperadiabaticLayer> find_superadiabatic(const Profile &profile, const Scan &scan) {
  std::vector<SuperadiabaticLayer> layers;
  for (const Scan::Range &range : scan.ranges(bends_up)) {
    const Sample low = sample_at(profile, range.bottom_m), high = sample_at(profile, range.top_m);
    const SuperadiabaticLayer layer{range.bottom_m, range.top_m, low.temperature_K - high.temperature_K,
                                    high.log_index - low.log_index};
    if (layer.index_rise >= least_drop) layers.push_back(layer);
  }
  return layers;
}

}  // namespace

double ray_curvature(const Profile &profile, double height_m) { return sample_at(profile, height_m).curvature(); }

double modified_index(const Profile &profile, double height_m) {
  return std::log1p(profile.refractivity(height_m, diagnosis_wavelength_nm).value) +
         std::log1p(height_m / profile.spec().earth_radius_m);
}

Diagnosis diagnose(const Profile &profile, std::optional<double> eye_height_m) {
  const Scan scan(profile);
  Diagnosis diagnosis;
  diagnosis.curvature_at_ground = ray_curvature(profile, 0);
  diagnosis.ducts = find_ducts(profile, scan);
  diagnosis.inversions = find_inversions(profile, scan);
  diagnosis.superadiabatic = find_superadiabatic(profile, scan);
  diagnosis.expect = mirages_to_expect(profile, diagnosis, eye_height_m);
  return diagnosis;
}

}  // namespace greenray
