// What the Sun of a scene does as it sets, in numbers: the sky's bands and folds, the disk's pieces, flattening, green
// rim and green flash. From the transfer curve alone, no picture needed.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "compute/device.hpp"
#include "render/spectrum.hpp"
#include "render/transfer_curve.hpp"
#include "scene/scene.hpp"

namespace greenray {

/// Apparent altitudes, low below high.
struct ApparentSpan {
  double low_deg, high_deg;
};

/// Where true altitude t(a) turns: erect and inverted images of the sky meet.
struct Fold {
  double apparent_deg, true_deg;
  bool lowest;  // t has a minimum here: what is below is not seen on either side
};

/// The Sun outside the air.
struct TrueSun {
  double centre_rad, radius_rad;
};

/// Bands of apparent altitude from which light of the sky comes, ascending; between two of them lies a blank strip.
/// Whole as long as the curve is traced there.
std::vector<ApparentSpan> sky_bands(const TransferCurve &curve, std::size_t wave);

/// Folds within the bands, ascending; reversals of t by less than least_arcsec (rounding, interpolation) are none.
std::vector<Fold> folds_of(const TransferCurve &curve, std::size_t wave, double least_arcsec = 1);

/// The parts of the vertical through the Sun's centre that show the Sun, ascending: since the disk is convex and
/// refraction keeps azimuths, as many as the seen Sun has pieces.
std::vector<ApparentSpan> pieces_of(const TransferCurve &curve, std::size_t wave, const TrueSun &sun);

/// Angle at the eye across the seen Sun's widest row [rad]; 0 where it is not seen.
double widest_row_rad(const TransferCurve &curve, std::size_t wave, const TrueSun &sun);

/// Lowest true altitude seen [rad]; none where a band ends at a duct's edge, for there is no lowest.
std::optional<double> lowest_true_rad(const TransferCurve &curve, std::size_t wave);

/* Spectral irradiance of the seen disk at the eye, on a surface that faces it [W m^-2 nm^-1], of each wavelength of
   `air`. waves: their rows in the curve;  extinction along the curve's own rays, limb darkening as `air` has it
   differs: the disk is taken as flat (0.27 degree: 1e-5), the ray between two entries as dim as midway between them */
std::vector<double> disk_irradiance(const TransferCurve &curve, const std::vector<std::size_t> &waves,
                                    const std::vector<SpectralAir> &air, const TrueSun &sun);

struct GreenFlash {
  double seconds = 0;                  // of green light
  double first_deg = 0, last_deg = 0;  // true altitude of the Sun's centre when it begins and ends
  double brightest_lux = 0;            // while green
};

inline constexpr double setting_rate_arcsec_s = 15;  // a Sun that sets straight down
inline constexpr double least_flash_lux = 1e-3;      // less of the disk's light is not counted

/* The green flash at the end of the Sun's setting: how long the light of all that is seen of the disk, taken together,
   is green, and still 0.001 lux. Green: Y > 1.25 X and Y > Z (CIE 1931), dominant wavelengths of about 498 to 570 nm.
   The Sun sinks by 15" a second of true altitude, in steps of 0.05 s, from where 5 % of its light is left. */
GreenFlash green_flash(const TransferCurve &curve, const std::vector<std::size_t> &waves,
                       const std::vector<SpectralAir> &air, double radius_rad);

/// All of it for a scene, at 550 nm unless said.
struct SunsetFigures {
  std::vector<ApparentSpan> sky;  // within 2 degrees of the picture's middle
  std::vector<Fold> folds;
  std::optional<TrueSun> sun;  // none: the scene has no Sun, and what follows is empty
  std::vector<ApparentSpan> pieces;
  std::vector<Image> images_of_centre;
  double vertical_arcsec = 0, horizontal_arcsec = 0;  // of all pieces together; their ratio is the flattening
  std::optional<double> green_rim_arcsec;             // upper limb at 520 nm above that at 650 nm
  std::optional<double> last_500_deg, last_550_deg, last_560_deg, last_650_deg;  // lowest true altitude seen
  std::optional<GreenFlash> flash;  // none in air that varies along the surface
  double curve_arcsec = 0;          // interpolation error of the curve
};

/// Throws InputError as `render` does. Rays in double.
SunsetFigures sunset_figures(const Scene &scene, const std::shared_ptr<Device> &device);

}  // namespace greenray
