// From spectra to colours: colour matching functions, Rec. 709, the sRGB curve, OKLab and the gamut.
#pragma once
#include <array>
#include <vector>

#include "image/spectral_image.hpp"

namespace greenray {

using Rgb = std::array<double, 3>;    // linear Rec. 709, D65 white
using Xyz = std::array<double, 3>;    // Y in cd/m2 where the picture is absolute
using OkLab = std::array<double, 3>;  // lightness (1 = white), a, b

inline constexpr double luminous_efficacy_lm_W = 683.002;  // of 555 nm in air: 683 lm/W at exactly 540 THz

enum class ColourMatching { cie1931, cie2015 };  // both 2 degrees

/// XYZ [cd/m2] per spectral radiance [W m^-2 sr^-1 nm^-1] of each sampled wavelength.
struct SpectralWeights {
  std::vector<double> x, y, z;
};

/* Weights of samples joined by straight lines: w_i = 683.002 x integral of (hat of sample i) x colour matching
   function. wavelength_nm: strictly ascending, two at least; nothing is assumed beyond the first and the last sample
   errors: fewer than two, or not ascending -> std::domain_error
   source: CIE 15 tables at 5 nm, brought to 1 nm by cubic (Lagrange) interpolation, straight between; the products
           are then integrated exactly */
SpectralWeights spectral_weights(const std::vector<double> &wavelength_nm,
                                 ColourMatching observer = ColourMatching::cie1931);

/// Colour matching functions (xbar, ybar, zbar) at a wavelength; zero outside the table.
Xyz colour_matching(double wavelength_nm, ColourMatching observer = ColourMatching::cie1931);

/// The spectral picture in linear Rec. 709, absolute (cd/m2). Colours outside Rec. 709 have negative parts. A picture
/// of one wavelength is grey, with the luminance of a band 1 nm wide.
RgbImage rgb_from_spectral(const SpectralImage &image, ColourMatching observer = ColourMatching::cie1931);

/// Photopic luminance of every pixel [cd/m2].
std::vector<float> luminance_cd_m2(const SpectralImage &image);

/* Matrices of ITU-R BT.709 primaries and D65 (0.3127, 0.3290), derived from those chromaticities so that they agree
   with the `chromaticities` attribute of our EXR files; white (1,1,1) has Y = 1. */
Xyz xyz_from_rgb(const Rgb &rgb);
Rgb rgb_from_xyz(const Xyz &xyz);
/// Y of a linear Rec. 709 colour, in the units of the colour.
double luminance(const Rgb &rgb);

/// IEC 61966-2-1 transfer curve, continued as an odd function below zero.
double srgb_encode(double linear);
double srgb_decode(double encoded);

/// Ottosson 2020: perceptual lightness, and a hue angle that stays put as chroma falls.
OkLab oklab_from_rgb(const Rgb &rgb);
Rgb rgb_from_oklab(const OkLab &lab);

/// The linear steps of OKLab: Rec. 709 to cone responses, their cube roots to L, a, b, and both ways back.
std::array<double, 3> ok_cones_from_rgb(const Rgb &rgb);
Rgb ok_rgb_from_cones(const std::array<double, 3> &cones);
OkLab ok_lab_from_roots(const std::array<double, 3> &roots);
std::array<double, 3> ok_roots_from_lab(const OkLab &lab);

/* Display-linear colour into [0,1]^3 by lowering OKLab chroma at constant hue and lightness.
   returns: true if the colour was outside (by more than 1e-6) and has moved */
bool map_into_gamut(Rgb &rgb);

}  // namespace greenray
