// Bleaching of rows of a picture: how much pigment is left under each pixel, and the colour that is seen with it.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "vision/bleaching.hpp"
#include "vision/cones.hpp"

namespace greenray::vision {

enum class BleachModel {
  catch_,     // each cone's signal falls with its pigment
  shape,      // the same, and the sensitivity curve narrows as self-screening goes
  threshold,  // Cornsweet 1970 as G04 reads it: 10^(-3 (1 - u)), a law of dark adaptation, kept for comparison
  adapted     // the nerves make up for what the pool of all pixels has lost: g = u / (u of the pool)^k
};

struct BleachingOptions {
  enum class Exposure { off, steady, seconds } exposure = Exposure::off;
  double seconds = 0;  // of looking, from an eye at rest
  BleachModel model = BleachModel::catch_;
  double neural = 1;    // k of `adapted`: 1 all is made up for, 0 nothing
  bool pooled = false;  // true: fixation wanders, the disk (half the peak and more) bleaches as one
  bool dims = false;    // true: luminance falls with the catch; false: only colours change (G04 6.2)
  Pigment pigment = rushton_henry;
};

/// How much catch per pigment grows as a pigment bleaches: r at u -> 0 and u = 0.5; r(1) = 1, a parabola between.
struct SelfScreening {
  float at_none[3] = {1, 1, 1}, at_half[3] = {1, 1, 1};
};

/* Self-screening of colours without spectra: the light is taken as a sum of three smooth bands (Gaussians at 610, 545
   and 450 nm, 25 nm wide) with the same L, M and S. */
class BandScreening {
 public:
  BandScreening();
  SelfScreening of(const Lms &lms) const;

 private:
  std::array<std::array<double, 3>, 3> amounts_{};        // [band][cone]: of the bands that make an LMS
  std::array<std::array<double, 3>, 3> none_{}, half_{};  // [cone][band]: catch per pigment
};

/// The same from spectra: weights of each sample, catch per pigment at u = 1, 0.5 and -> 0, all to one scale.
struct SpectralScreening {
  explicit SpectralScreening(const std::vector<double> &wavelength_nm);
  /// radiance: of the first wavelength; of the next one `spacing` further on. What is no light is left out.
  SelfScreening of(const float *radiance, std::size_t spacing) const;
  std::array<std::vector<float>, 3> whole, half, none;  // [cone][wavelength]
};

/// What is common to all pixels of a picture.
struct Retina {
  BleachingOptions options;
  std::array<float, 3> td_per_lms{};   // cone trolands of LMS 1 cd/m2: pupil, effectivity, and the cone's own factor
  std::array<float, 3> pool{1, 1, 1};  // u of the pool: for `adapted`
  std::optional<std::array<float, 3>> shared;  // u of every pixel, where pooled

  bool bleaches() const { return options.exposure != BleachingOptions::Exposure::off; }
  /// Unbleached fraction after this picture's exposure.
  double after(double before, double td) const;
};

/// Response of a kind of cone [cd/m2, fundamentals of peak 1] to colours x, y, z.
void cone_response(std::size_t cone, const float *x, const float *y, const float *z, std::size_t count, float *to);

/// Kinetics under this picture's exposure, each of u by its own light; floats, within 3e-7 of Retina::after.
void expose_cones(const Retina &retina, std::size_t cone, const float *response, std::size_t count, float *u);

/* count pixels. x, y, z: colour, changed in place; luminance: changed only if options.dims.
   u[3]: unbleached fractions: before this picture on entry, after it on return.
   screening: [count] for `shape`, else empty.
   With all fractions 1 nothing changes, to the last bit. */
void bleach_rows(const Retina &retina, std::size_t count, float *x, float *y, float *z, float *luminance,
                 const std::array<float *, 3> &u, const std::vector<SelfScreening> &screening);

}  // namespace greenray::vision
