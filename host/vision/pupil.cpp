#include "vision/pupil.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace greenray::vision {

namespace {

double watson_yellott(const PupilField &field) {
  const double eyes = field.eyes >= 2 ? 1.0 : 0.1;
  const double flux = field.luminance_cd_m2 * field.area_deg2 * eyes;
  const double response = std::pow(flux / 846.0, 0.41);
  const double young = std::isinf(response) ? 2.0 : 7.75 - 5.75 * response / (response + 2.0);
  return young + (field.age_years - 28.58) * (0.021323 - 0.0095623 * young);
}

/// log10 d = 0.8558 - 0.000401 (log10 L + offset)^3
double de_groot(double luminance_cd_m2, double offset) {
  const double level = std::log10(luminance_cd_m2) + offset;
  return std::pow(10.0, 0.8558 - 0.000401 * level * level * level);
}

}  // namespace

double pupil_diameter_mm(PupilModel model, const PupilField &field, bool clamp) {
  if (!(field.luminance_cd_m2 >= 0) || std::isinf(field.luminance_cd_m2))
    throw std::domain_error("pupil: expected a finite luminance of 0 or more");
  double diameter = 0;
  switch (model) {
    case PupilModel::watson_yellott:
      diameter = watson_yellott(field);
      break;
    case PupilModel::de_groot:
      diameter = de_groot(field.luminance_cd_m2, 7.597);
      break;
    case PupilModel::moon_spencer:
      diameter = 4.9 - 3.0 * std::tanh(0.4 * std::log10(field.luminance_cd_m2));
      break;
    case PupilModel::g04:
      diameter = de_groot(field.luminance_cd_m2, 8.6);
      break;
  }
  return clamp ? std::clamp(diameter, 2.0, 8.0) : diameter;
}

double effectivity(double diameter_mm) {
  const double square = diameter_mm * diameter_mm;
  return 1.0 - 0.010625 * square + 4.1667e-5 * square * square;
}

double trolands(double luminance_cd_m2, double diameter_mm) {
  const double area_mm2 = std::numbers::pi / 4 * diameter_mm * diameter_mm;
  return effectivity(diameter_mm) * area_mm2 * luminance_cd_m2;
}

}  // namespace greenray::vision
