// Air that varies along the surface: n(h, x, lambda), a profile of its own over every place x of a path.
#pragma once
#include <memory>
#include <vector>

#include "atmosphere/profile.hpp"

namespace greenray {

/// Does n change with x? Not where all values of a list are alike, where an inversion of 0 K moves, or where n is 1.
bool varies_along_surface(const ProfileSpec &spec);

/// Does the profile speak of x at all, whether or not anything changes with it?
bool has_places(const ProfileSpec &spec);

/// The air over one place: every list of an inversion becomes one number, the stations on either side a blend.
/// x_m: along the surface [m]; constant beyond the first and the last point.
/// Between points x_m of an inversion: along_surface = "cubic" is monotone (Fritsch & Carlson 1980), so that the slopes
/// along x are continuous and nothing overshoots; "linear" is straight. Between stations the weight of the next one is
/// t^2 (3 - 2t), or t: T, relative humidity and ln P at the surface stay between those of the two, and no inversion
/// appears that neither has. P aloft is integrated anew from the blended T.
ProfileSpec frozen_at(const ProfileSpec &spec, double x_m);

class AirSection {
 public:
  /// errors: InputError where the air over a point or half way between two is impossible (T <= 0)
  explicit AirSection(ProfileSpec spec);
  const ProfileSpec &spec() const { return spec_; }
  Profile at(double x_m) const { return Profile(frozen_at(spec_, x_m)); }

  /// Points x_m, ascending, at which the interpolation may have a kink; nothing varies beyond the first and the last.
  /// Empty: nothing varies at all.
  const std::vector<double> &points_m() const { return points_m_; }
  /// Can one section serve all wavelengths? Not humid air: vapour has a dispersion of its own.
  bool is_separable() const { return separable_; }

 private:
  ProfileSpec spec_;
  std::vector<double> points_m_;
  bool separable_ = true;
};

}  // namespace greenray
