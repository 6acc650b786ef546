#include "render/sky_own_rays.hpp"

namespace greenray {
namespace {

struct RowSums {
  std::vector<float> spectra, moments;
  SkySums view() const { return {spectra, moments}; }
};

/// Apparent elevations of one sample of each pixel of the view's first row, and their azimuths.
struct RowOfSight {
  std::vector<double> elevations_rad;
  std::vector<float> azimuths_rad;
};

RowOfSight row_of_sight(const f32::SkyView &v, int sample) {
  RowOfSight row;
  for (int column = 0; column < v.width; ++column) {
    float x, y;
    f32::sample_place(&v, v.first_column + column, v.first_row, sample, &x, &y);
    const f32::SkyDirection d = f32::view_direction(&v, x, y);
    row.elevations_rad.push_back(static_cast<double>(d.elevation_rad));
    row.azimuths_rad.push_back(d.azimuth_rad);
  }
  row.elevations_rad.push_back(row.elevations_rad.back());  // look-up reads one entry further
  return row;
}

void add_sample(SkyRays &rays, const SkyLight &light, const OwnRayTargets &own_targets, const RenderPlan &plan,
                const f32::SkyView &v, int sample, RowSums &sums) {
  const RowOfSight row = row_of_sight(v, sample);
  std::vector<double> azimuths(row.azimuths_rad.begin(), row.azimuths_rad.end());
  azimuths.push_back(azimuths.back());
  TransferTable own = trace_directions(rays, row.elevations_rad, azimuths);
  own.rays = for_all_wavelengths(own.rays, own.wavelengths, light.air.size());
  own.wavelengths = light.air.size();
  const int waves = static_cast<int>(light.air.size());
  const SkyTable sky = make_sky_table(light, own, waves);
  TargetTable table;
  if (own_targets.places)
    table = make_target_table(own_targets.scene, own_targets.shapes, light, plan.wavelengths_nm,
                              trace_stations(*own_targets.places, row.elevations_rad, plan.station_m, azimuths), {}, {},
                              waves);
  const f32::Targets targets = table.view(waves);
  for (int column = 0; column < v.width; ++column) {
    const float half_azimuth = f32::sine_half_from_sun(&v, row.azimuths_rad[static_cast<std::size_t>(column)]);
    const f32::SkySample from = f32::sky_sample(&v, sky.values.data(), waves, column, 0,
                                                row.azimuths_rad[static_cast<std::size_t>(column)], half_azimuth);
    float band = 0;
    for (int w = 0; w < waves; ++w) {
      const float behind = f32::sky_radiance(&v, sky.values.data(), sky.disks.data(), waves, w, &from);
      const float radiance = f32::before_targets(&v, &targets, behind, behind, 0, w, column, 0,
                                                 row.azimuths_rad[static_cast<std::size_t>(column)], half_azimuth);
      sums.spectra[static_cast<std::size_t>(column * waves + w)] += radiance;
      band += radiance;
    }
    sums.moments[static_cast<std::size_t>(2 * column)] += band;
    sums.moments[static_cast<std::size_t>(2 * column + 1)] += band * band;
  }
}

}  // namespace

void shade_with_own_rays(SkyRays &rays, const SkyLight &light, const OwnRayTargets &targets, f32::SkyView view,
                         const RenderPlan &plan, const std::array<int, 2> &first_last, SkyPicture &picture) {
  view.rows = 1;
  const auto width = static_cast<std::size_t>(picture.width());
  for (int row = first_last[0]; row < first_last[1]; ++row) {
    view.first_row = plan.crop[1] + row;
    RowSums sums{std::vector<float>(width * light.air.size()), std::vector<float>(width * 2)};
    for (int sample = 0; sample < plan.spp; ++sample) add_sample(rays, light, targets, plan, view, sample, sums);
    picture.keep(sums.view(), row, 1, plan.spp);
  }
}

}  // namespace greenray
