// From adapted light to what a screen shows: tone curve, rods, sRGB primaries, gamut.
#pragma once
#include <cstddef>
#include <vector>

#include "vision/tone_curve.hpp"

namespace greenray::vision {

/* display_fraction() of a curve as a table in the bits of the float: 128 straight pieces an octave.
   error: about 1e-3 of the value at the corners of the curve, 2e-5 between; never falling */
class ToneTable {
 public:
  explicit ToneTable(const ToneCurve &curve);
  float fraction(float world_cd_m2) const;

 private:
  std::vector<float> fraction_;
};

enum class RodVision { off, ward, cie191 };

/* count pixels: colour x, y, z (any scale: only its chromaticity counts) with `luminance` [cd/m2] and, unless rods are
   off, `scotopic` [cd/m2]  ->  rgb [count][3]: display-linear Rec. 709 before the gamut; `luminance` becomes that of
   the mix of cones and rods. */
void display_rows(const ToneTable &tone, RodVision rods, std::size_t count, const float *x, const float *y,
                  const float *z, float *luminance, const float *scotopic, float *rgb);

/* Colours into [0,1]^3 at constant OKLab hue, on the straight way to a grey, to where it enters the gamut. For colours
   too bright in a channel that grey lies between their own lightness and 0.5, the more the stronger they are: an orange
   Sun at the white of the display gives up some lightness and stays orange. Neighbours stay neighbours.
   source: Ottosson 2021, "sRGB gamut clipping", adaptive L0 about 0.5 with alpha 0.5
   differs: never below the colour's lightness in the dark; the pull sets in with the overshoot of the strongest
   channel; colours that no light has count no darker than 0.96 of the grey of their luminance, and no stronger than a
   chroma of 0.4 returns: how many were outside by more than 1e-6 */
std::size_t gamut_rows(std::size_t count, float *rgb);

}  // namespace greenray::vision
