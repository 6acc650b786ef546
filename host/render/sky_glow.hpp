// Light of sky and sea for one picture: by elevation, azimuth from the Sun and wavelength.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "render/spectrum.hpp"
#include "scene/scene.hpp"
#include "sky/sea.hpp"
#include "sky/sky_field.hpp"

namespace greenray {

/// The optical constants of a scene's air, for its sky.
SkyOptics sky_optics(const AtmosphereScene &air, const std::vector<SpectralAir> &spectral,
                     const std::vector<double> &wavelength_nm);

/// The sky of a scene's air as its eye sees it, wherever the Sun stands; by the air at the eye where it varies along
/// the surface.
std::shared_ptr<const SkyField> sky_field(const Scene &scene, const Profile &air,
                                          const std::vector<SpectralAir> &spectral,
                                          const std::vector<double> &wavelength_nm);

/// Directions that a picture needs.
struct GlowRange {
  double low_rad, high_rad;          // elevations
  double nearest_rad, farthest_rad;  // azimuth from the Sun, 0..pi
};

/* Radiance over the range, tabulated: elevations halve themselves until a straight line is good to a part in 500,
   between the jumps (horizon, edges of ducts), which are known; azimuths are Chebyshev's extreme points of
   sin^2(azimuth/2), as many as a part in 500 needs, 17 at most. */
class SkyGlow {
 public:
  /// sun_altitude_rad: true. irradiance: of the Sun outside the air, [wavelengths], W m^-2 nm^-1.
  SkyGlow(std::shared_ptr<const SkyField> field, const SkyScene &sky, double sun_altitude_rad,
          std::vector<double> irradiance, const GlowRange &range);

  std::size_t azimuths() const { return azimuths_; }
  double nearest() const { return near_; }  // sin^2(azimuth/2) of the first and the last
  double farthest() const { return far_; }
  double azimuth_error() const { return azimuth_error_; }  // largest, relative, of interpolating between them

  /// A place in the table for a ray that ends in space, or does not.
  struct Place {
    const float *below, *above;  // rows of this elevation: [row_count()][padded]
    float fraction;
  };
  Place find(double elevation_rad, bool to_space) const;
  /// Rows of a place: glitter, grazing, the Sun at the sea; then glow and aureole of each azimuth, in the order and the
  /// meaning of the kernel's channels (kernels/shared/sky.h).
  std::size_t row_count() const { return first_azimuth + 2 * azimuths_; }
  static constexpr std::size_t first_azimuth = 3;
  double slope2() const { return sea_ && sea_->has_waves() ? sea_->slope2() : 0; }
  std::size_t padded() const { return field_->optics().padded(); }

  /// The air between the eye and a distance along the surface, at the middle azimuth. A line that ends before counts
  /// to its end.
  struct AirBefore {
    std::vector<double> elevation_rad;
    std::vector<float> rows;  // [elevations][glow, aureole][padded]
  };
  AirBefore air_before(double distance_m) const;
  const SkyField &field() const { return *field_; }

 private:
  struct Interval {  // between two jumps
    double low_rad, high_rad;
    bool to_space;
    std::vector<double> elevation_rad;
    std::vector<float> rows;
  };
  std::vector<float> rows(double elevation_rad, const std::vector<double> &places) const;
  std::vector<double> azimuth_places(std::size_t count) const;
  void choose_azimuths(const GlowRange &range);
  void fill(Interval &interval) const;
  void refine(double low, double high, const std::vector<float> &at_low, const std::vector<float> &at_high,
              Interval &interval, int depth) const;

  std::shared_ptr<const SkyField> field_;
  double sun_altitude_rad_;
  std::vector<double> irradiance_;
  std::optional<Sea> sea_;
  std::size_t azimuths_ = 2;
  double near_ = 0, far_ = 1, azimuth_error_ = 0;
  std::vector<Interval> intervals_;
};

}  // namespace greenray
