#include "vision/colour_difference.hpp"

#include <cmath>
#include <numbers>

namespace greenray::vision {

namespace {

constexpr double deg = std::numbers::pi / 180;

double lab_curve(double t) {
  constexpr double delta = 6.0 / 29.0;
  return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29.0;
}

double angle_deg(double a, double b) {
  if (a == 0 && b == 0) return 0;
  const double angle = std::atan2(b, a) / deg;
  return angle < 0 ? angle + 360 : angle;
}

double seventh_power_share(double chroma) {
  const double c7 = std::pow(chroma, 7), limit = 6103515625.0;  // 25^7
  return std::sqrt(c7 / (c7 + limit));
}

/// Mean of two hues, the short way round; of a grey and a hue, the hue.
double mean_hue_deg(double h1, double h2, double chroma_product) {
  if (chroma_product == 0) return h1 + h2;
  const double mean = 0.5 * (h1 + h2);
  if (std::abs(h1 - h2) <= 180) return mean;
  return mean < 180 ? mean + 180 : mean - 180;
}

}  // namespace

Lab lab_from_xyz(const std::array<double, 3> &xyz) {
  const double x = lab_curve(xyz[0] / 0.95047), y = lab_curve(xyz[1]), z = lab_curve(xyz[2] / 1.08883);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

double hue_deg(const Lab &lab) { return angle_deg(lab[1], lab[2]); }

double hue_shift_deg(double from_deg, double to_deg) {
  const double shift = to_deg - from_deg;
  return shift > 180 ? shift - 360 : shift <= -180 ? shift + 360 : shift;
}

double ciede2000(const Lab &first, const Lab &second) {
  const double mean_c = 0.5 * (std::hypot(first[1], first[2]) + std::hypot(second[1], second[2]));
  const double stretch = 1 + 0.5 * (1 - seventh_power_share(mean_c));
  const double a1 = stretch * first[1], a2 = stretch * second[1];
  const double c1 = std::hypot(a1, first[2]), c2 = std::hypot(a2, second[2]);
  const double h1 = angle_deg(a1, first[2]), h2 = angle_deg(a2, second[2]);
  const double dl = second[0] - first[0], dc = c2 - c1;
  const double dh = c1 * c2 == 0 ? 0 : 2 * std::sqrt(c1 * c2) * std::sin(0.5 * deg * hue_shift_deg(h1, h2));

  const double l = 0.5 * (first[0] + second[0]), c = 0.5 * (c1 + c2), h = mean_hue_deg(h1, h2, c1 * c2);
  const double t = 1 - 0.17 * std::cos(deg * (h - 30)) + 0.24 * std::cos(deg * 2 * h) +
                   0.32 * std::cos(deg * (3 * h + 6)) - 0.20 * std::cos(deg * (4 * h - 63));
  const double from_50 = (l - 50) * (l - 50);
  const double weight_l = 1 + 0.015 * from_50 / std::sqrt(20 + from_50);
  const double weight_c = 1 + 0.045 * c, weight_h = 1 + 0.015 * c * t;
  const double turn = (h - 275) / 25;
  const double rotation = -2 * seventh_power_share(c) * std::sin(2 * deg * 30 * std::exp(-turn * turn));
  const double el = dl / weight_l, ec = dc / weight_c, eh = dh / weight_h;
  return std::sqrt(el * el + ec * ec + eh * eh + rotation * ec * eh);
}

}  // namespace greenray::vision
