// Air in thin shells: where any ray goes and what it passes, by Bouguer's law, in double on the host. For light that is
// scattered on the way, which needs the whole path and not only its end.
#pragma once
#include <array>
#include <cmath>
#include <vector>

#include "atmosphere/index_table.hpp"
#include "atmosphere/layer_table.hpp"

namespace greenray {

/// Columns along a path: air [kg/m^2], ozone and aerosol [m], each the integral of density, or of a shape that is 1 at
/// its peak, as in kernels/shared/ray.h.
struct Columns {
  double air = 0, ozone = 0, aerosol = 0;
  Columns operator+(const Columns &b) const { return {air + b.air, ozone + b.ozone, aerosol + b.aerosol}; }
  Columns operator-(const Columns &b) const { return {air - b.air, ozone - b.ozone, aerosol - b.aerosol}; }
  Columns operator*(double f) const { return {air * f, ozone * f, aerosol * f}; }
};

/// A place on a path and all that lies between it and the path's start.
struct PathPlace {
  double height_m = 0;
  double along_m = 0;        // along the surface; over the radius it is the angle at the Earth's centre
  double elevation_rad = 0;  // of the path, above the horizontal of this place
  double bending_rad = 0;    // turned downward so far
  double length_m = 0;
  Columns column;
};

enum class PathEnd { space, ground, endless };  // endless: trapped, or level above a flat surface

struct AirPath {
  std::vector<PathPlace> places;  // the start first, the end last
  PathEnd end = PathEnd::space;
};

class AirShells {
 public:
  /// Shells between these heights [m], ascending, from the ground to the medium's top or beyond. In each the square of
  /// sin(elevation) is linear in height; densities and the slope of the index are parabolas through both ends and the
  /// mean, of which lengths, bending and columns follow exactly, also where a ray turns (docs/method.md, Layers in
  /// closed form).
  /// absorbers: shapes of ozone and aerosol, of which the aerosol's is that of the surface upward.
  AirShells(const LayeredMedium &medium, double wavelength_nm, const LayerAbsorbers &absorbers,
            std::vector<double> heights_m);

  double radius_m() const { return radius_m_; }  // 0: flat
  double top_m() const { return shells_.back().height_m; }
  std::size_t levels() const { return shells_.size(); }
  double height_m(std::size_t level) const { return shells_[level].height_m; }
  /// n (R + h) [m]: how far the asymptotes of a ray that is level there pass the Earth's centre. Over a sphere.
  double impact_m(std::size_t level) const { return radius_m_ * std::exp(shells_[level].log_index); }
  /// Densities at any height: air [kg/m^3], ozone and aerosol as shapes.
  Columns density(double height_m) const;
  /// Angle at the Earth's centre [rad]; 0 over a flat surface.
  double centre_angle_rad(double along_m) const { return radius_m_ > 0 ? along_m / radius_m_ : 0; }

  /// The path from a level at an elevation [rad], as far as longest_m. Its places are where it crosses levels and
  /// turns.
  AirPath path(std::size_t level, double elevation_rad, double longest_m = 1e9) const;
  /// Its end alone.
  struct Exit {
    PathEnd end;
    double bending_rad;
    Columns column;
    double along_m;
  };
  Exit exit(std::size_t level, double elevation_rad) const;
  /// The lowest elevation [rad] at which a path from this level clears the ground and the levels below it; 0 where
  /// nothing below turns rays back before the ground does.
  double lowest_clear_rad(std::size_t level) const;
  /// Elevations [rad], ascending, at which a ray from a level just clears or just misses an extreme of N, on either
  /// side, or the ground; and 0. Between two of them all that becomes of it changes smoothly.
  std::vector<double> breaks_rad(std::size_t level) const;

 private:
  struct Shell {                  // from this level to the next
    double height_m, log_index;   // ln N, flattened
    double flattened_m, stretch;  // (1 + h/R) in its middle
    Columns density;              // at the level
    /// Over the shell, by t from its foot 0 to its top 1: mean + tilt (t - 1/2) + bow (6 t^2 - 6 t + 1).
    Columns mean, tilt, bow;
    double bend_mean = 0, bend_tilt = 0, bend_bow = 0;  // of -d(ln n)/dz, flattened
  };
  struct Walker;
  template <class Keep>
  PathEnd walk(std::size_t level, double elevation_rad, double longest_m, Keep &&keep) const;

  std::vector<Shell> shells_;
  double radius_m_;
};

/// Heights for `AirShells`: fine near the ground, the eye and the medium's own features, each step at most `step` of
/// the height above the surface or of the distance from the eye, and never over step x 8 km below 40 km, where the edge
/// of the Earth's shadow lies in twilight, and a quarter of step of the height above.
std::vector<double> shell_heights(const LayeredMedium &medium, const std::vector<double> &features_m, double eye_m,
                                  double step);

}  // namespace greenray
