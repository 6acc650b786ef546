#include "sky/air_shells.hpp"

#include <algorithm>
#include <cmath>

#include "support/angle.hpp"

namespace greenray {
namespace {

constexpr int most_turns = 64;  // of a ray in a duct

double flattened(double height_m, double radius_m) {
  return radius_m > 0 ? radius_m * std::log1p(height_m / radius_m) : height_m;
}

/// Mean over a shell of what falls or rises exponentially between its ends.
double mean_of_exponential(double a, double b) {
  if (a <= 0 || b <= 0 || std::abs(a - b) <= 1e-4 * (a + b)) return 0.5 * (a + b);
  return (a - b) / std::log(a / b);
}

/// -d(ln n)/dz, flattened.
double bend_per_m(const LayeredMedium &medium, double wavelength_nm, double height_m) {
  if (height_m > medium.top_m) return 0;
  const Dual n = medium.refractivity(height_m, wavelength_nm);
  return -n.slope / (1 + n.value) * (medium.radius_m > 0 ? 1 + height_m / medium.radius_m : 1);
}

/// Integrals of 1, t - 1/2 and 6 t^2 - 6 t + 1 over a piece on which the sine's square goes from a^2 to b^2, divided by
/// the sine.
struct PieceWeights {
  double mean, tilt, bow;
  PieceWeights(double a, double b) {
    const double r = 1 / (a + b), steeper = (b - a) * r;
    mean = 2 * r, tilt = -steeper * r / 3, bow = 0.4 * steeper * steeper * r;
  }
};

}  // namespace

AirShells::AirShells(const LayeredMedium &medium, double wavelength_nm, const LayerAbsorbers &absorbers,
                     std::vector<double> heights_m)
    : radius_m_(medium.radius_m) {
  for (double h : heights_m) {
    Shell s{};
    const bool in_air = h <= medium.top_m;
    s.height_m = h;
    s.flattened_m = flattened(h, radius_m_);
    s.log_index = std::log1p(in_air ? medium.refractivity(h, wavelength_nm).value : 0) +
                  (radius_m_ > 0 ? s.flattened_m / radius_m_ : 0);
    const double from_peak = (h - absorbers.ozone_peak_m) / absorbers.ozone_width_m;
    s.density = {in_air ? medium.density_kg_m3(h) : 0, std::exp(-0.5 * from_peak * from_peak),
                 std::exp(-h / absorbers.aerosol_scale_m)};
    shells_.push_back(s);
  }
  for (std::size_t k = 0; k + 1 < shells_.size(); ++k) {
    Shell &s = shells_[k];
    const Shell &next = shells_[k + 1];
    const double middle_m = 0.5 * (s.height_m + next.height_m), thick = next.flattened_m - s.flattened_m;
    const double from_peak = (middle_m - absorbers.ozone_peak_m) / absorbers.ozone_width_m;
    s.stretch = radius_m_ > 0 ? 1 + middle_m / radius_m_ : 1;
    s.mean = {mean_of_exponential(s.density.air, next.density.air),
              (s.density.ozone + next.density.ozone + 4 * std::exp(-0.5 * from_peak * from_peak)) / 6,
              mean_of_exponential(s.density.aerosol, next.density.aerosol)};
    s.tilt = next.density - s.density;
    s.bow = (s.density + next.density) * 0.5 - s.mean;
    // Kinks lie at levels: slopes are those within the shell.
    const double inside_m = 1e-6 * (next.height_m - s.height_m);
    const double foot = bend_per_m(medium, wavelength_nm, s.height_m + inside_m);
    const double top = bend_per_m(medium, wavelength_nm, next.height_m - inside_m);
    s.bend_mean = (radius_m_ > 0 ? 1 / radius_m_ : 0) - (next.log_index - s.log_index) / thick;
    s.bend_tilt = top - foot;
    s.bend_bow = 0.5 * (foot + top) - s.bend_mean;
  }
}

Columns AirShells::density(double height_m) const {
  const auto above = std::upper_bound(shells_.begin(), shells_.end(), height_m,
                                      [](double h, const Shell &s) { return h < s.height_m; });
  if (above == shells_.begin()) return shells_.front().density;
  if (above == shells_.end()) return shells_.back().density;
  const Shell &a = *(above - 1), &b = *above;
  const double t = (height_m - a.height_m) / (b.height_m - a.height_m);
  const auto between = [t](double x, double y) { return x > 0 && y > 0 ? x * std::pow(y / x, t) : x + t * (y - x); };
  return {between(a.density.air, b.density.air), between(a.density.ozone, b.density.ozone),
          between(a.density.aerosol, b.density.aerosol)};
}

/// A path on its way. With sin^2 e linear in z the sine is linear along the chord, and a piece between the sines a and
/// b that climbs dz is 2 dz/(a + b) long.
struct AirShells::Walker {
  PathPlace place;
  double longest_m;

  /// Through a piece of a shell, from sine a at t = from to sine b at t = to, to a height that is known. False: it
  /// ended on the way.
  bool go(const Shell &s, double thick_m, double from, double to, double a, double b, double to_height_m) {
    const double whole_m = 2 * std::abs(to - from) * thick_m / (a + b);
    const double left_m = (longest_m - place.length_m) / s.stretch;
    const double done = std::min(1.0, left_m / whole_m), chord_m = whole_m * done;
    const double sine = a + (b - a) * done, sign = to > from ? 1 : -1;
    const double cosine = std::sqrt(std::max(0.0, 1 - (a * a + a * sine + sine * sine) / 3));
    const double reached = done < 1 ? from + (to - from) * done * (a + sine) / (a + b) : to;
    const double part_m = std::abs(reached - from) * thick_m;
    const auto mean_of = [&](auto mean, auto tilt, auto bow) {  // along the piece, by its length
      const double span2 = (reached - from) * (reached - from);
      const auto near = mean + tilt * (from - 0.5) + bow * (6 * from * (from - 1) + 1);
      const auto far = mean + tilt * (reached - 0.5) + bow * (6 * reached * (reached - 1) + 1);
      const PieceWeights weigh(a, sine);
      return (((near + far) * 0.5 - bow * span2) * weigh.mean + (far - near) * weigh.tilt + bow * (span2 * weigh.bow)) *
             part_m;
    };
    if (part_m > 0) {
      place.column = place.column + mean_of(s.mean, s.tilt, s.bow) * s.stretch;
      place.bending_rad += cosine * mean_of(s.bend_mean, s.bend_tilt, s.bend_bow);
    }
    place.length_m += chord_m * s.stretch;
    place.along_m += chord_m * cosine;
    place.elevation_rad = sign * std::asin(std::min(1.0, sine));
    place.height_m = done < 1 ? place.height_m + sign * part_m * s.stretch : to_height_m;
    return done >= 1;
  }
};

/// From level to level; a path that turns in a shell comes back through it by the mirror image of its way.
template <class Keep>
PathEnd AirShells::walk(std::size_t level, double elevation_rad, double longest_m, Keep &&keep) const {
  const double sine0 = std::sin(elevation_rad), cosine0 = std::cos(elevation_rad);
  const double start_log = shells_[level].log_index;
  const auto sine2 = [&](std::size_t k) {  // of the elevation at a level; below 0: not reached
    return sine0 * sine0 - cosine0 * cosine0 * std::expm1(2 * (start_log - shells_[k].log_index));
  };
  const bool rises = level == 0 || (level + 1 < shells_.size() && sine2(level + 1) > 0);
  bool up = sine0 > 0 || (sine0 == 0 && rises);
  std::size_t at = level;
  double near2 = sine0 * sine0;
  Walker walker{{}, longest_m};
  walker.place.height_m = shells_[level].height_m;
  walker.place.elevation_rad = elevation_rad;
  keep(walker.place);
  for (int turns = 0; turns <= most_turns;) {
    if (up && at + 1 == shells_.size()) return PathEnd::space;
    if (!up && at == 0) return PathEnd::ground;
    const std::size_t next = up ? at + 1 : at - 1;
    const Shell &s = shells_[std::min(at, next)];
    const double thick = shells_[std::min(at, next) + 1].flattened_m - s.flattened_m;
    const double a = std::sqrt(near2), far2 = sine2(next);
    if (far2 > 0) {
      const bool went = walker.go(s, thick, up ? 0 : 1, up ? 1 : 0, a, std::sqrt(far2), shells_[next].height_m);
      keep(walker.place);
      if (!went) return PathEnd::endless;
      at = next, near2 = far2;
      continue;
    }
    if (near2 == far2) return PathEnd::endless;  // level, and nothing bends it
    const double part = near2 / (near2 - far2), sign = up ? 1 : -1;
    if (part > 0) {
      const double lowest_m = walker.place.height_m + sign * part * thick * s.stretch;
      const double edge = up ? 0 : 1, turn = edge + sign * part;
      bool went = walker.go(s, thick, edge, turn, a, 0, lowest_m);
      keep(walker.place);
      went = went && walker.go(s, thick, turn, edge, 0, a, shells_[at].height_m);
      keep(walker.place);
      if (!went) return PathEnd::endless;
    }
    up = !up;
    ++turns;
  }
  return PathEnd::endless;
}

AirPath AirShells::path(std::size_t level, double elevation_rad, double longest_m) const {
  AirPath path;
  path.places.reserve(2 * shells_.size());
  path.end = walk(level, elevation_rad, longest_m, [&](const PathPlace &p) { path.places.push_back(p); });
  return path;
}

AirShells::Exit AirShells::exit(std::size_t level, double elevation_rad) const {
  PathPlace last;
  const PathEnd end = walk(level, elevation_rad, 1e12, [&](const PathPlace &p) { last = p; });
  return {end, last.bending_rad, last.column, last.along_m};
}

double AirShells::lowest_clear_rad(std::size_t level) const {
  double least = shells_[level].log_index;
  for (std::size_t k = 0; k < level; ++k) least = std::min(least, shells_[k].log_index);
  const double lift = -std::expm1(2 * (shells_[level].log_index - least));  // 1 - (N/N_least)^2, not above 0
  return -std::atan(std::sqrt(std::max(0.0, -lift)));
}

std::vector<double> AirShells::breaks_rad(std::size_t level) const {
  std::vector<double> breaks{0};
  const auto clearances = [&](std::size_t k, bool up) {
    double least = shells_[level].log_index;
    const std::size_t last = up ? shells_.size() - 1 : 0;
    while (k != last) {
      k = up ? k + 1 : k - 1;
      const double here = shells_[k].log_index;
      if (here >= least) continue;
      least = here;
      if (k != last && shells_[up ? k + 1 : k - 1].log_index <= least) continue;
      const double turning = std::atan(std::sqrt(std::expm1(2 * (shells_[level].log_index - least))));
      breaks.insert(breaks.end(), {-turning, turning});
    }
  };
  clearances(level, true);
  clearances(level, false);
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  return breaks;
}

std::vector<double> shell_heights(const LayeredMedium &medium, const std::vector<double> &features_m, double eye_m,
                                  double step) {
  const double top = std::max(medium.top_m, eye_m);
  std::vector<double> marks{0, top};
  for (double h : features_m)
    if (h > 0 && h < top) marks.push_back(h);
  if (eye_m > 0) marks.push_back(eye_m);
  std::sort(marks.begin(), marks.end());
  marks.erase(std::unique(marks.begin(), marks.end()), marks.end());
  std::vector<double> heights{0};
  constexpr double finest_m = 0.5, shadow_m = 40000;  // the Earth's shadow lies below that while twilight is bright
  const auto coarsest = [](double h) { return h < shadow_m ? 8000 : h / 4; };
  for (std::size_t i = 0; i + 1 < marks.size(); ++i) {
    if (marks[i] >= medium.top_m) {  // nothing there
      heights.push_back(marks[i + 1]);
      continue;
    }
    for (double h = marks[i]; h < marks[i + 1];) {
      const double from_eye = std::abs(h - eye_m);
      h += std::max(finest_m, step * std::min({h + 1, from_eye + 2, coarsest(h)}));
      if (h > marks[i + 1] - finest_m / 2) h = marks[i + 1];
      heights.push_back(h);
    }
  }
  return heights;
}

}  // namespace greenray
