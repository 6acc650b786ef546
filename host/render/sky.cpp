#include "render/sky.hpp"

#include <cmath>

#include "support/angle.hpp"
#include "support/parallel.hpp"

namespace greenray {

double optical_depth(const Transfer &ray, const SpectralAir &air) {
  return ray.column[0] * air.rayleigh_per_kg_m2 + ray.column[2] * air.aerosol_per_m + ray.column[1] * air.ozone_per_m;
}

namespace {

static_assert(f32::SKY_LIGHT - f32::SKY_GLITTER == SkyGlow::first_azimuth);

/// Radiance of the Sun's centre that a ray would show.
double sun_radiance(const SkyLight &light, const Transfer &ray, std::size_t wave) {
  if (ray.outcome != f64::RAY_SPACE || !light.sun.shines) return 0;
  const SpectralAir &air = light.air[wave];
  const bool academic = light.sky.model == SkyScene::Model::academic;
  return air.sun_centre_radiance * (academic ? 1 : std::exp(-optical_depth(ray, air)));
}

/// Rows of one entry: [SKY_LIGHT + 2 azimuths][waves].
void fill_entry(const SkyLight &light, const TransferTable &transfer, std::size_t entry, std::size_t padded,
                float *rows) {
  for (std::size_t w = 0; w < light.air.size(); ++w) {
    const Transfer &ray = transfer.at(entry, w);
    rows[f32::SKY_FROM_SUN * padded + w] = static_cast<float>(ray.true_altitude_rad - light.sun.true_altitude_rad);
    rows[f32::SKY_SUN * padded + w] = static_cast<float>(sun_radiance(light, ray, w));
    rows[f32::SKY_JOINED * padded + w] = transfer.edges.empty() ? 1.0f : transfer.edges[entry * light.air.size() + w];
  }
  if (!light.glow) return;
  const SkyGlow::Place space = light.glow->find(elevation_rad(transfer.at(entry, 0)), true);
  const SkyGlow::Place ground = light.glow->find(elevation_rad(transfer.at(entry, 0)), false);
  for (std::size_t m = 0; m < light.glow->row_count(); ++m)
    for (std::size_t w = 0; w < light.air.size(); ++w) {
      const SkyGlow::Place &p = transfer.at(entry, w).outcome == f64::RAY_SPACE ? space : ground;
      const float a = p.below[m * light.glow->padded() + w], b = p.above[m * light.glow->padded() + w];
      rows[(f32::SKY_GLITTER + m) * padded + w] = a + p.fraction * (b - a);
    }
}

}  // namespace

SkyTable make_sky_table(const SkyLight &light, const TransferTable &transfer, int waves) {
  const std::vector<SpectralAir> &air = light.air;
  const auto padded = static_cast<std::size_t>(waves);
  SkyTable table;
  table.entries = static_cast<int>(transfer.entries);
  table.waves = waves;
  table.channels = static_cast<int>(f32::SKY_LIGHT + 2 * (light.glow ? light.glow->azimuths() : 0));
  const std::size_t row = static_cast<std::size_t>(table.channels) * padded;
  table.values.assign(transfer.entries * row, 0.0f);
  table.limb.assign(air.front().limb.size() * padded, 0.0f);
  for (std::size_t w = 0; w < air.size(); ++w)
    for (std::size_t k = 0; k < air[w].limb.size(); ++k)
      table.limb[k * padded + w] = static_cast<float>(air[w].limb[k]);
  constexpr std::size_t piece = 64;
  for_pieces(transfer.entries, piece, host_threads(), [&](std::size_t first, std::size_t last) {
    for (std::size_t e = first; e < last; ++e) fill_entry(light, transfer, e, padded, &table.values[e * row]);
  });
  return table;
}

void set_azimuths(const SkyGlow *glow, f32::SkyView &view) {
  view.azimuths = glow ? static_cast<int>(glow->azimuths()) : 0;
  if (!glow) return;
  view.azimuth_middle = static_cast<float>(0.5 * (glow->nearest() + glow->farthest()));
  view.azimuth_per_half = static_cast<float>(2 / (glow->farthest() - glow->nearest()));
  for (std::size_t m = 0; m < glow->azimuths(); ++m)
    view.azimuth_places[m] =
        static_cast<float>(-std::cos(pi * static_cast<double>(m) / static_cast<double>(glow->azimuths() - 1)));
  view.slope2 = static_cast<float>(glow->slope2());
  view.phase_asymmetry = static_cast<float>(glow->field().optics().aerosol_asymmetry);
}

}  // namespace greenray
