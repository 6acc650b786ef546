// Reflectance spectra that have a given colour.
#pragma once
#include <array>
#include <map>

#include "image/colour.hpp"

namespace greenray {

/// c0, c1, c2 of SpectrumCurve (kernels/shared/material.h).
using CurveCoefficients = std::array<double, 3>;

/// Place of a wavelength on the curve's axis: 0 at 360 nm, 1 at 830 nm.
double curve_place(double wavelength_nm);
double curve_value(const CurveCoefficients &c, double wavelength_nm);

/* Smooth reflectances between 0 and 1 whose colour under D65 (CIE 1931) is the one asked for; colours on the rim of
   Rec. 709 are met as closely as reflectances can.
   source: Jakob & Hanika, EGSR 2019; differs: solved by Gauss and Newton's method from grey in small steps of colour,
   with residuals in linear Rec. 709, instead of from a table */
class Uplift {
 public:
  Uplift();
  CurveCoefficients coefficients(const Rgb &linear);
  /// Colour of a curve under D65, white being (1, 1, 1).
  Rgb colour(const CurveCoefficients &c) const;

 private:
  CurveCoefficients solve(const Rgb &target) const;

  std::array<Rgb, 95> weight_{};                           // of each 5 nm from 360 to 830
  std::map<std::array<int, 3>, CurveCoefficients> known_;  // by colour in steps of 1/4096
};

}  // namespace greenray
