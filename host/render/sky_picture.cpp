#include "render/sky_picture.hpp"

#include <cmath>

#include "support/angle.hpp"
#include "support/parallel.hpp"

namespace greenray {
namespace {

constexpr std::size_t piece = 4096;  // pixels that a thread takes at a time

/// Of the sum over wavelengths.
double variance_of_mean(const SkySums &sums, std::size_t pixel, int samples) {
  if (samples < 2) return 0;
  const double mean = sums.moments[2 * pixel] / static_cast<double>(samples);
  const double square = sums.moments[2 * pixel + 1] / static_cast<double>(samples);
  return std::max(0.0, square - mean * mean) / (samples - 1);
}

double relative(double variance_sum, double band_sum, double pixels) {
  return band_sum > 0 ? std::sqrt(variance_sum / pixels) / (band_sum / pixels) : 0;
}

}  // namespace

SkyPicture::SkyPicture(const RenderPlan &plan) : waves_(plan.wavelengths_nm.size()), crop_(plan.crop) {
  image_.width = crop_[2] - crop_[0];
  image_.height = crop_[3] - crop_[1];
  image_.wavelength_nm = plan.wavelengths_nm;
  image_.radiance.resize(image_.pixels() * waves_);
  image_.channels["variance"].resize(image_.pixels());
}

void SkyPicture::keep(const SkySums &sums, int first_row, int rows, int samples) {
  const std::size_t width = static_cast<std::size_t>(image_.width), pixels = width * static_cast<std::size_t>(rows);
  const std::size_t padded = sums.spectra.size() / pixels, first = static_cast<std::size_t>(first_row) * width;
  const float scale = 1.0f / static_cast<float>(samples);
  const double bands = static_cast<double>(waves_);
  float *variances = image_.channels["variance"].data() + first, *radiance = image_.radiance.data() + first * waves_;
  for_pieces(pixels, piece, host_threads(), [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      for (std::size_t w = 0; w < waves_; ++w) radiance[i * waves_ + w] = sums.spectra[i * padded + w] * scale;
      variances[i] = static_cast<float>(variance_of_mean(sums, i, samples) / (bands * bands));
    }
  });
  for (std::size_t i = 0; i < pixels; ++i) {  // in one order, for the same bits
    variance_sum_ += variance_of_mean(sums, i, samples);
    band_sum_ += sums.moments[2 * i] * scale;
  }
}

double SkyPicture::noise_rms() const {
  return relative(variance_sum_, band_sum_, static_cast<double>(image_.pixels()));
}

void SkyPicture::describe(const f32::SkyView &view, const TransferTable &table) {
  auto &bending = image_.channels["bending_arcsec"], &distance = image_.channels["distance_m"],
       &lowest = image_.channels["min_height_m"];
  bending.resize(image_.pixels());
  distance.resize(image_.pixels());
  lowest.resize(image_.pixels());
  const auto describe_pixel = [&](std::size_t i) {
    const int x = static_cast<int>(i) % image_.width, y = static_cast<int>(i) / image_.width;
    const f32::SkyDirection d =
        f32::view_direction(&view, static_cast<float>(x + crop_[0]) + 0.5f, static_cast<float>(y + crop_[1]) + 0.5f);
    const double at = (static_cast<double>(d.elevation_rad) - table.first_elevation_rad) / table.spacing_rad;
    const auto entry = static_cast<std::size_t>(std::clamp(std::round(at), 0.0, double(table.entries - 1)));
    const Transfer &t = table.at(entry, waves_ / 2);
    bending[i] = static_cast<float>(to_arcsec(t.bending_rad));
    distance[i] = static_cast<float>(t.distance_m);
    lowest[i] = static_cast<float>(t.min_height_m);
  };
  for_pieces(image_.pixels(), piece, host_threads(), [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) describe_pixel(i);
  });
}

void SkyPicture::describe_targets(const f32::SkyView &view, const TargetTable &table, const StationSights &sights) {
  auto &distance = image_.channels["target_distance_m"], &height = image_.channels["target_height_m"];
  distance.resize(image_.pixels());
  height.resize(image_.pixels());
  const int waves = static_cast<int>(table.light.size() / (f32::TARGET_LIGHT_FIRST + table.targets.size()));
  const int wave = static_cast<int>(waves_ / 2);
  const f32::Targets targets = table.view(waves);
  const auto describe_pixel = [&](std::size_t i) {
    const int x = static_cast<int>(i) % image_.width, y = static_cast<int>(i) / image_.width;
    const f32::SkyDirection d =
        f32::view_direction(&view, static_cast<float>(x + crop_[0]) + 0.5f, static_cast<float>(y + crop_[1]) + 0.5f);
    const float at = std::clamp((d.elevation_rad - view.first_elevation_rad) * view.entries_per_rad, 0.0f,
                                static_cast<float>(view.entries - 1));
    const int entry = std::min(static_cast<int>(at), view.entries - 2);
    const f32::TargetHit hit =
        f32::nearest_target(&targets, wave, entry, at - static_cast<float>(entry), d.azimuth_rad);
    if (hit.target < 0) return;
    const auto station = static_cast<std::size_t>(table.targets[static_cast<std::size_t>(hit.target)].station);
    distance[i] = static_cast<float>(sights.station_m[station]);
    height[i] = hit.height_m;
  };
  for_pieces(image_.pixels(), piece, host_threads(), [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) describe_pixel(i);
  });
}

double relative_noise(const SkySums &sums, int samples) {
  double variance = 0, band = 0;
  for (std::size_t i = 0; i < sums.moments.size() / 2; ++i) {
    variance += variance_of_mean(sums, i, samples);
    band += sums.moments[2 * i] / static_cast<double>(samples);
  }
  return relative(variance, band, static_cast<double>(sums.moments.size()) / 2);
}

}  // namespace greenray
