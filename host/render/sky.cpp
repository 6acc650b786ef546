#include "render/sky.hpp"

#include <algorithm>
#include <cmath>

#include "support/angle.hpp"
#include "support/parallel.hpp"

namespace greenray {

double optical_depth(const Transfer &ray, const SpectralAir &air) {
  return ray.column[0] * air.rayleigh_per_kg_m2 + ray.column[2] * air.aerosol_per_m + ray.column[1] * air.ozone_per_m;
}

namespace {

static_assert(f32::SKY_LIGHT - f32::SKY_GLITTER == SkyGlow::first_azimuth);

/// Share of the light from outside that a ray brings.
double passed(const SkyLight &light, const Transfer &ray, std::size_t wave) {
  if (ray.outcome != f64::RAY_SPACE) return 0;
  return light.sky.model == SkyScene::Model::academic ? 1 : std::exp(-optical_depth(ray, light.air[wave]));
}

/// Rows of the kernel's table of disks.
std::vector<float> disk_rows(const SkyLight &light, std::size_t padded) {
  std::vector<float> rows((f32::DISK_MOON_SHADOW + light.moon.shadow.size()) * padded, 0.0f);
  for (std::size_t w = 0; w < light.air.size(); ++w) {
    const SpectralAir &air = light.air[w];
    for (std::size_t k = 0; k < air.limb.size() && light.sun.shines; ++k)
      rows[k * padded + w] = static_cast<float>(air.limb[k] * air.sun_centre_radiance);
    if (light.moon.shines) rows[f32::DISK_MOON * padded + w] = static_cast<float>(light.moon.radiance[w]);
    for (std::size_t i = 0; i < light.moon.shadow.size(); ++i)
      rows[(f32::DISK_MOON_SHADOW + i) * padded + w] = light.moon.shadow[i][w];
  }
  return rows;
}

/// Rows of one entry: [SKY_LIGHT + 2 azimuths][waves].
void fill_entry(const SkyLight &light, const TransferTable &transfer, std::size_t entry, std::size_t padded,
                float *rows) {
  for (std::size_t w = 0; w < light.air.size(); ++w) {
    const Transfer &ray = transfer.at(entry, w);
    rows[f32::SKY_FROM_SUN * padded + w] = static_cast<float>(ray.true_altitude_rad - light.sun.true_altitude_rad);
    rows[f32::SKY_PASSED * padded + w] = static_cast<float>(passed(light, ray, w));
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

PathLight light_of_path(const SkyLight &light, const Transfer &ray, const SkyGlow::AirBefore *air, std::size_t wave) {
  if (light.sky.model == SkyScene::Model::academic) return {1, 0, 0};
  const double left = std::exp(-optical_depth(ray, light.air[wave]));
  if (!light.glow || !air) return {left, 0, 0};
  const std::vector<double> &elevations = air->elevation_rad;
  const double e = elevation_rad(ray);
  const auto next = std::upper_bound(elevations.begin(), elevations.end(), e);
  const auto k = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(next - elevations.begin() - 1, 0, static_cast<std::ptrdiff_t>(elevations.size()) - 2));
  const double width = std::max(elevations[k + 1] - elevations[k], 1e-300);
  const double t = std::clamp((e - elevations[k]) / width, 0.0, 1.0);
  const std::size_t padded = light.glow->padded();
  const float *below = &air->rows[2 * k * padded + wave], *above = below + 2 * padded;
  return {left, below[0] + t * (above[0] - below[0]), below[padded] + t * (above[padded] - below[padded])};
}

GroundLight light_on_ground(const SkyLight &light, std::size_t wave) {
  const SunPlace &sun = light.sun;
  const Transfer &ray = light.towards_sun[wave];
  const double outside = light.irradiance.empty() ? 0 : light.irradiance[wave];
  const bool direct = (sun.shines || light.moon.shines) && ray.outcome == f64::RAY_SPACE &&
                      std::abs(ray.true_altitude_rad - sun.true_altitude_rad) < sun.radius_rad;
  const double by_sun = direct ? outside * std::exp(-optical_depth(ray, light.air[wave])) : 0;
  if (!light.glow) return {by_sun, 0};
  const DiffuseLight &diffuse = light.glow->field().diffuse();
  std::vector<float> by_sky(diffuse.padded());
  diffuse.irradiance(sun.true_altitude_rad, by_sky.data());
  return {by_sun, outside * static_cast<double>(by_sky[wave])};
}

double irradiance_on_upright(const SkyLight &light, double azimuth_rad, std::size_t wave) {
  const SunPlace &sun = light.sun;
  const double outside = light.irradiance.empty() ? 0 : light.irradiance[wave];
  const double towards_eye = -std::cos(sun.azimuth_rad - azimuth_rad);  // cosine of the azimuths of Sun and surface
  const double facing = std::cos(sun.true_altitude_rad) * towards_eye;
  const double by_sun = std::max(facing, 0.0) * light_on_ground(light, wave).sun;
  if (!light.glow) return by_sun;
  // Of light whose radiance is mean + 3 flux . direction a surface takes pi mean + 2 pi flux . normal.
  const DiffuseLight &diffuse = light.glow->field().diffuse();
  const DiffuseLight::Look look = diffuse.look(diffuse.at_height(0), sun.true_altitude_rad);
  double mean = 0, sunward = 0;
  for (std::size_t i = 0; i < look.row.size(); ++i) {
    mean += look.weight[i] * look.row[i][wave];
    sunward += look.weight[i] * look.row[i][2 * diffuse.padded() + wave];
  }
  return by_sun + outside * std::max(0.0, pi * mean + 2 * pi * sunward * towards_eye);
}

SkyTable make_sky_table(const SkyLight &light, const TransferTable &transfer, int waves) {
  const auto padded = static_cast<std::size_t>(waves);
  SkyTable table;
  table.entries = static_cast<int>(transfer.entries);
  table.waves = waves;
  table.channels = static_cast<int>(f32::SKY_LIGHT + 2 * (light.glow ? light.glow->azimuths() : 0));
  const std::size_t row = static_cast<std::size_t>(table.channels) * padded;
  table.values.assign(transfer.entries * row, 0.0f);
  table.disks = disk_rows(light, padded);
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
  if (view.azimuths == 1) view.azimuth_places[0] = 0;
  else
    for (std::size_t m = 0; m < glow->azimuths(); ++m)
      view.azimuth_places[m] =
          static_cast<float>(-std::cos(pi * static_cast<double>(m) / static_cast<double>(glow->azimuths() - 1)));
  view.slope2 = static_cast<float>(glow->slope2());
  view.phase_asymmetry = static_cast<float>(glow->field().optics().aerosol_asymmetry);
}

}  // namespace greenray
