#include "atmosphere/mirage_words.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "support/angle.hpp"

namespace greenray {
namespace {

constexpr double at_the_ground_m = 0.02;        // a layer that begins this low is on the ground
constexpr double band_of_standard = 0.05;       // k this near 0.17 is ordinary
constexpr double mock_mirage_curvature = 0.34;  // twice the standard: slices of a low Sun can repeat below an eye above
constexpr double weather_top_m = 5000.0;        // inversions higher up leave no mirage to see

std::string metres(double m) { return plain_number(m) + " m"; }
std::string range_of(double bottom_m, double top_m) { return plain_number(bottom_m) + " to " + metres(top_m); }

/// Elevation at M `from` of the ray that is level at M `to`, if there is one.
std::optional<double> elevation_rad(double from, double to) {
  return from < to ? std::nullopt : std::optional(std::acos(std::exp(to - from)));
}

/// Mean k from the ground to the eye (2 m without one), of the lowest 50 m at most.
std::string looming(const Profile &profile, std::optional<double> eye_m) {
  const double upto_m = std::clamp(eye_m.value_or(2.0), 0.5, 50.0);
  const double fall = std::log1p(profile.refractivity(0, diagnosis_wavelength_nm).value) -
                      std::log1p(profile.refractivity(upto_m, diagnosis_wavelength_nm).value);
  const double k = fall / upto_m * profile.spec().earth_radius_m;
  const std::string mean =
      "k = " + plain_number(k, 2) + " on average over the lowest " + metres(upto_m) + " (standard 0.17): ";
  if (k >= 1) return "Looming: " + mean + "rays curve more than the Earth and the surface seems hollow";
  if (k > standard_ray_curvature + band_of_standard)
    return "Looming: " + mean + "far things stand higher and the horizon lies farther off";
  if (k < 0) return "Sinking: " + mean + "rays bend upwards and the horizon lies nearer than without air";
  if (k < standard_ray_curvature - band_of_standard)
    return "Sinking: " + mean + "far things stand lower and the horizon lies nearer";
  return "Ordinary refraction: " + mean + "neither looming nor sinking";
}

std::string rising(const Profile &profile, const SuperadiabaticLayer &layer, std::optional<double> eye_m) {
  const std::string where = "refractivity rises with height from " + range_of(layer.bottom_m, layer.top_m);
  const bool on_ground = layer.bottom_m < at_the_ground_m;
  if (!on_ground) return "Rays bend upwards in a layer aloft: " + where;
  const double turned_from_m = std::min(eye_m.value_or(layer.top_m), layer.top_m);
  const double rise = std::log1p(profile.refractivity(turned_from_m, diagnosis_wavelength_nm).value) -
                      std::log1p(profile.refractivity(layer.bottom_m, diagnosis_wavelength_nm).value);
  return "Inferior mirage: " + where + "; the layer turns back rays that enter it at less than " +
         plain_angle(std::acos(std::exp(-std::max(rise, 0.0)))) + " below level, as if from a sheet of water";
}

std::string about(const Profile &profile, const Duct &duct, std::optional<double> eye_m) {
  const std::string where =
      "duct from " + range_of(duct.bottom_m, duct.top_m) + " (traps from " + metres(duct.trapping_bottom_m) + ")";
  if (!eye_m)
    return "Superior mirage: " + where + ", holds rays up to " + plain_angle(to_rad(duct.widest_trapped_deg)) +
           " from level; towering or Fata Morgana from within it, mock mirages from above it";
  const double top = modified_index(profile, duct.top_m), eye = modified_index(profile, *eye_m);
  const std::optional<double> limit = elevation_rad(eye, top);
  if (*eye_m > duct.top_m)
    return "Mock mirage: " + where + " below the eye" +
           (limit ? "; slices of a low Sun repeat near " + plain_angle(*limit) + " below level" : "");
  if (*eye_m >= duct.bottom_m && limit)
    return "Superior mirage: the eye is in the " + where + "; rays within " + plain_angle(*limit) +
           " of level are held and follow the surface: towering and Fata Morgana, and no light of the sky in that "
           "strip";
  return "Superior mirage of far things only: " + where +
         " above the eye; its light is bent but none that the eye sees is held";
}

std::optional<std::string> about(const Inversion &inversion, std::optional<double> eye_m) {
  if (inversion.bottom_m > weather_top_m || inversion.largest_curvature >= 1)
    return std::nullopt;  // ducts speak for themselves
  if (inversion.largest_curvature < mock_mirage_curvature) return std::nullopt;
  const std::string where = "inversion of " + plain_number(inversion.rise_K, 2) + " K from " +
                            range_of(inversion.bottom_m, inversion.top_m) + ", k up to " +
                            plain_number(inversion.largest_curvature, 2) + ", no duct";
  if (eye_m && *eye_m <= inversion.top_m) return "Towering or stooping at the height of the eye or above: " + where;
  return std::string("Mock mirage") + (eye_m ? "" : ", from above") + ": " + where + (eye_m ? " below the eye" : "") +
         "; a low Sun can show slices, and a green flash with them";
}

}  // namespace

std::string plain_number(double value, int significant) {
  if (!std::isfinite(value)) return "-";
  if (value == 0) return "0";
  char text[400];
  std::snprintf(text, sizeof text, "%.*e", significant - 1, value);
  const double rounded = std::strtod(text, nullptr);
  const auto end = std::to_chars(text, text + sizeof text, rounded, std::chars_format::fixed).ptr;
  return std::string(text, end);
}

std::string plain_angle(double angle_rad) {
  const double deg = to_deg(angle_rad);
  if (deg >= 1) return plain_number(deg) + " deg";
  return deg >= 0.02 ? plain_number(deg * 60) + " arc-minutes" : plain_number(deg * 3600) + " arc-seconds";
}

std::vector<std::string> mirages_to_expect(const Profile &profile, const Diagnosis &found,
                                           std::optional<double> eye_height_m) {
  std::vector<std::string> sentences{looming(profile, eye_height_m)};
  for (const SuperadiabaticLayer &layer : found.superadiabatic)
    sentences.push_back(rising(profile, layer, eye_height_m));
  for (const Duct &duct : found.ducts) sentences.push_back(about(profile, duct, eye_height_m));
  for (const Inversion &inversion : found.inversions)
    if (const auto sentence = about(inversion, eye_height_m)) sentences.push_back(*sentence);
  return sentences;
}

}  // namespace greenray
