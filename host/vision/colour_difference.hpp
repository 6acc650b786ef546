// How different two colours look: CIELAB and CIEDE2000.
#pragma once
#include <array>

namespace greenray::vision {

using Lab = std::array<double, 3>;  // L*, a*, b*

/// CIE 15:2004, relative to D65 (0.95047, 1, 1.08883); xyz: Y = 1 for white.
Lab lab_from_xyz(const std::array<double, 3> &xyz);

/// Hue angle in [0, 360): red near 30, yellow near 90, green near 160, blue near 280; 0 for a grey.
double hue_deg(const Lab &lab);

/// The way from one hue to another, in (-180, 180].
double hue_shift_deg(double from_deg, double to_deg);

/* Colour difference with weights 1.
   source: CIE 142-2001; the corner cases as in Sharma, Wu & Dalal 2005 */
double ciede2000(const Lab &a, const Lab &b);

}  // namespace greenray::vision
