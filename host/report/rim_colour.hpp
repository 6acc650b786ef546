// The colour of the Sun's upper rim in a picture, from above it downwards, as it is and to an eye that the disk has
// bleached.
#pragma once
#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "image/spectral_image.hpp"
#include "image/svg.hpp"

namespace greenray {

struct RimPoint {
  double above_rim_arcsec = 0, luminance_cd_m2 = 0;
  double u = 0, v = 0;  // CIE 1976 u'v'
  double bleached_u = 0, bleached_v = 0;
  std::optional<double> looks_like_nm, bleached_looks_like_nm;  // the single wavelength of the same L : M
  std::vector<double> radiance;                                 // W m^-2 sr^-1 nm^-1, at the picture's wavelengths
};

struct RimColour {
  int column = 0, row = 0;                    // of the rim, in the picture as written
  double seconds = 0;                         // that the eye looked at the disk; infinity: for good
  std::array<double, 3> unbleached{1, 1, 1};  // L, M, S
  std::vector<double> wavelength_nm;
  std::vector<RimPoint> points;  // from the top downwards
};

/* Along the column through the brightest part, where light rises above a quarter of the column's largest.
   pixel_arcsec: of a pixel;  seconds: of bleaching by the disk's own light (catch model, Rushton & Henry)
   returns: nothing where no disk stands out, or the picture has fewer than two wavelengths */
std::optional<RimColour> rim_colour(const SpectralImage &image, double pixel_arcsec, double seconds);

nlohmann::json rim_json(const RimColour &rim);
/// Spectra of some points, and chromaticity along the column.
std::vector<Plot> rim_figures(const RimColour &rim);

}  // namespace greenray
