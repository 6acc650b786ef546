#include "vision/adaptation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vision/acuity.hpp"

namespace greenray::vision {

namespace {

/// Luminances of a plane at evenly scattered places.
std::vector<float> scattered_values(const Plane &plane, std::size_t count) {
  if (plane.value.size() <= count) return plane.value;
  std::vector<float> values;
  const double stride = static_cast<double>(plane.value.size()) / static_cast<double>(count);
  constexpr double golden = 0.6180339887498949;  // a different place in each stretch
  for (std::size_t i = 0; i < count; ++i) {
    const double place = (static_cast<double>(i) + std::fmod(golden * static_cast<double>(i), 1.0)) * stride;
    values.push_back(plane.value[std::min(static_cast<std::size_t>(place), plane.value.size() - 1)]);
  }
  return values;
}

BrightnessHistogram histogram_of(const RetinalLight &light, const Plane &foveal, const ViewGeometry &view) {
  const std::vector<float> points =
      light.has_glare() ? scattered_values(light.luminance_cells(), point_count(view)) : light.survey().points;
  return histogram_from_samples(foveal.value, std::vector<float>(foveal.value.size(), 1.0F), points);
}

}  // namespace

std::size_t point_count(const ViewGeometry &view) {
  const std::array<int, 2> foveal = foveal_size(view);
  return std::clamp<std::size_t>(16 * static_cast<std::size_t>(foveal[0]) * static_cast<std::size_t>(foveal[1]), 4096,
                                 1U << 20U);
}

std::array<int, 2> foveal_size(const ViewGeometry &view) {
  constexpr double deg = std::numbers::pi / 180, sun_radius_deg = 0.2666;
  const double cell = (view.fov_deg < 5 ? sun_radius_deg : 1.0) * deg;
  return {std::max(2, static_cast<int>(std::lround(2 * view.half_width / cell))),
          std::max(2, static_cast<int>(std::lround(2 * view.half_height / cell)))};
}

Plane foveal_samples(const Plane &cells, const ViewGeometry &view) {
  const std::array<int, 2> wanted = foveal_size(view);
  Plane samples(std::min(wanted[0], cells.width), std::min(wanted[1], cells.height));
  for (int y = 0; y < samples.height; ++y)
    for (int x = 0; x < samples.width; ++x) {
      const auto from = [](int i, int size, int count) {
        return static_cast<int>(static_cast<long long>(i) * size / count);
      };
      double sum = 0;
      int count = 0;
      for (int cy = from(y, cells.height, samples.height); cy < from(y + 1, cells.height, samples.height); ++cy)
        for (int cx = from(x, cells.width, samples.width); cx < from(x + 1, cells.width, samples.width); ++cx, ++count)
          sum += static_cast<double>(cells.row(cy)[cx]);
      samples.row(y)[x] = static_cast<float>(sum / count);
    }
  return samples;
}

PupilField pupil_field(const ViewGeometry &view, double mean_cd_m2, double surround_cd_m2, const EyeOptions &options) {
  constexpr double least_field_deg2 = 60;
  const double picture_deg2 = view.area_deg2(), field_deg2 = std::max(picture_deg2, least_field_deg2);
  const double flux = mean_cd_m2 * picture_deg2 + surround_cd_m2 * (field_deg2 - picture_deg2);
  return {flux / field_deg2, field_deg2, options.eye.age_years, options.eyes};
}

Adaptation adapt(const RetinalLight &light, const ViewGeometry &view, const EyeOptions &options, EyeReport &report) {
  const Plane foveal = foveal_samples(light.luminance_cells(), view);
  report.foveal = {foveal.width, foveal.height};
  const BrightnessHistogram histogram = histogram_of(light, foveal, view);
  const ToneCurve curve(histogram, options.display, options.sensitivity);
  report.linear = curve.is_linear();
  report.linear_scale = curve.linear_scale();
  report.tone_passes = curve.passes();
  Adaptation adaptation{ToneTable(curve), RodVision::off, std::nullopt};
  if (histogram.dark()) return adaptation;
  report.histogram_low_cd_m2 = std::exp(histogram.low);
  report.histogram_high_cd_m2 = std::exp(histogram.high);
  report.adaptation_cd_m2 = std::exp(histogram.mean);
  const double fifth_cd_m2 = report.fifth_percentile_cd_m2 = histogram.percentile_cd_m2(0.05);
  if (options.rods != RodVision::off && fifth_cd_m2 < top_of_mesopic_cd_m2) adaptation.rods = options.rods;
  report.rods_applied = adaptation.rods != RodVision::off;
  if (options.acuity && acuity_cycles_deg(fifth_cd_m2) * view.pixel_deg < 1) {
    adaptation.acuity.emplace(foveal, view);
    if (adaptation.acuity->resolves_everything()) adaptation.acuity.reset();
  }
  report.acuity_applied = adaptation.acuity.has_value();
  if (adaptation.acuity) report.coarsest_sample_pixels = std::exp2(static_cast<double>(adaptation.acuity->coarsest()));
  return adaptation;
}

Retina open_pupil(const RetinalLight &light, const ViewGeometry &view, const EyeOptions &options, EyeReport &report) {
  const PupilField field = pupil_field(view, light.survey().mean_cd_m2, light.surround_cd_m2(), options);
  report.field_cd_m2 = field.luminance_cd_m2;
  report.field_deg2 = field.area_deg2;
  report.pupil_mm = pupil_diameter_mm(options.pupil, field);
  report.effectivity = effectivity(report.pupil_mm);
  report.td_per_cd_m2 = trolands(1, report.pupil_mm);
  Retina retina;
  retina.options = options.bleaching;
  for (std::size_t i = 0; i < 3; ++i)
    retina.td_per_lms[i] = static_cast<float>(report.td_per_cd_m2 * cone_troland_factors()[i]);
  return retina;
}

}  // namespace greenray::vision
