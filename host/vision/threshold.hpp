// The smallest difference of luminance that the eye sees.
#pragma once

namespace greenray::vision {

/* Threshold [cd/m2] of an eye adapted to adaptation_cd_m2 (>= 0): rods and cones, whichever sees more.
   The pieces do not quite meet: -2.7 % at log10 L = -1.44, -0.7 % at 1.9, 0.03 % at 1.148e-4 cd/m2. The published jumps
   are kept. source: Ferwerda, Pattanaik, Shirley & Greenberg, SIGGRAPH 1996, as used by Ward Larson et al. 1997 */
double luminance_threshold_cd_m2(double adaptation_cd_m2);

}  // namespace greenray::vision
