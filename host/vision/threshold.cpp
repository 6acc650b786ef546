#include "vision/threshold.hpp"

#include <cmath>

namespace greenray::vision {

double luminance_threshold_cd_m2(double adaptation_cd_m2) {
  if (!(adaptation_cd_m2 >= 1.148e-4)) return 1.38e-3;
  const double level = std::log10(adaptation_cd_m2);
  double threshold = 0;
  if (level < -1.44) threshold = std::pow(0.405 * level + 1.6, 2.18) - 2.86;
  else if (level < -0.0184) threshold = level - 0.395;
  else if (level < 1.9) threshold = std::pow(0.249 * level + 0.65, 2.7) - 0.72;
  else threshold = level - 1.255;
  return std::pow(10.0, threshold);
}

}  // namespace greenray::vision
