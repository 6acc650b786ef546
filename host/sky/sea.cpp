#include "sky/sea.hpp"

#include <algorithm>
#include <cmath>

#include "support/angle.hpp"
#include "support/parallel.hpp"

namespace greenray {
namespace {

constexpr double water_index = 1.34;  // sea water, 550 nm
constexpr double deg = pi / 180;

/// Slopes of waves in units of their RMS: a wheel of equal shares, whose mean square is 1.
struct Slope {
  double along, across;
};
std::vector<Slope> make_slope_wheel() {
  constexpr int rings = 6, spokes = 12;
  std::vector<Slope> wheel;
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < spokes; ++s) {
      const double size = std::sqrt(-std::log(1 - (r + 0.5) / rings)), angle = 2 * pi * (s + 0.5 * (r % 2)) / spokes;
      wheel.push_back({size * std::cos(angle), size * std::sin(angle)});
    }
  return wheel;
}
const std::vector<Slope> &slope_wheel() {
  static const std::vector<Slope> wheel = make_slope_wheel();
  return wheel;
}

/// Unit vector to a facet of these slopes, and how much of it is seen from an elevation over what is level.
struct Facet {
  double x, y, z;  // x: away from the eye
  Facet(double along, double across) : x(-along), y(-across), z(1) {
    const double length = std::sqrt(1 + along * along + across * across);
    x /= length, y /= length, z /= length;
  }
};

}  // namespace

double fresnel_water(double cosine) {
  const double c = std::clamp(cosine, 0.0, 1.0), sine2 = 1 - c * c;
  const double inside = std::sqrt(1 - sine2 / (water_index * water_index));
  const double across = (c - water_index * inside) / (c + water_index * inside);
  const double along = (water_index * c - inside) / (water_index * c + inside);
  return 0.5 * (across * across + along * along);
}

double mean_square_slope(double wind_m_s) { return 0.003 + 0.00512 * wind_m_s; }

Sea::Sea(const SkyField &field, std::vector<double> sun_altitudes_rad, double wind_m_s, double fixed_reflectance)
    : field_(field),
      slope2_(mean_square_slope(wind_m_s)),
      fixed_reflectance_(fixed_reflectance),
      sun_rad_(std::move(sun_altitudes_rad)),
      elevation_rad_(
          {0, 0.7 * deg, 1.5 * deg, 3 * deg, 6 * deg, 10 * deg, 16 * deg, 25 * deg, 40 * deg, 60 * deg, pi / 2}),
      azimuth_rad_({0, 5 * deg, 12 * deg, 22 * deg, 36 * deg, 55 * deg, 80 * deg, 110 * deg, 145 * deg, pi}) {
  const std::size_t elevations = elevation_rad_.size(), azimuths = azimuth_rad_.size(), n = field.optics().padded();
  dome_.assign(sun_rad_.size() * elevations * azimuths * n, 0.0f);
  for_pieces(elevations, 1, host_threads(), [&](std::size_t first, std::size_t last) {
    for (std::size_t e = first; e < last; ++e) {
      const double elevation = std::max(elevation_rad_[e], field.shells().lowest_clear_rad(0) + 1e-6);
      const ScatterPath path = scatter_path(field.shells(), field.optics(), field.sunlight(), field.diffuse(),
                                            field.shells().path(0, elevation), elevation);
      for (std::size_t s = 0; s < sun_rad_.size(); ++s)
        for (std::size_t a = 0; a < azimuths; ++a)
          add_scattered(path, field.optics(), {&field.sunlight(), &field.diffuse(), 0}, sun_rad_[s],
                        std::cos(azimuth_rad_[a]), &dome_[((s * elevations + e) * azimuths + a) * n]);
    }
  });
}

/// The sky above the sea, interpolated.
void Sea::add_sky(double sun_altitude_rad, double elevation_rad, double azimuth_rad, float weight, float *light) const {
  const std::size_t elevations = elevation_rad_.size(), azimuths = azimuth_rad_.size(), n = field_.optics().padded();
  const Axis::Place e = elevation_rad_.find(elevation_rad), a = azimuth_rad_.find(std::abs(azimuth_rad));
  std::size_t s = 0;
  while (s + 2 < sun_rad_.size() && sun_rad_[s + 1] <= sun_altitude_rad) ++s;
  const bool one = sun_rad_.size() < 2;
  const double t = one ? 0 : std::clamp((sun_altitude_rad - sun_rad_[s]) / (sun_rad_[s + 1] - sun_rad_[s]), 0.0, 1.0);
  for (int corner = 0; corner < (one ? 4 : 8); ++corner) {
    const bool next_e = corner & 1, next_a = corner & 2, next_s = corner & 4;
    const double share =
        (next_e ? e.fraction : 1 - e.fraction) * (next_a ? a.fraction : 1 - a.fraction) * (next_s ? t : 1 - t);
    const float *row = &dome_[(((s + next_s) * elevations + e.cell + next_e) * azimuths + a.cell + next_a) * n];
    const float w = weight * static_cast<float>(share);
    for (std::size_t i = 0; i < n; ++i) light[i] += w * row[i];
  }
}

/// Mean over slopes, for an eye `grazing_rad` above the sea's horizontal that looks `azimuth_rad` from the Sun.
void Sea::mirror(double sun_altitude_rad, double grazing_rad, double azimuth_rad, float *light) const {
  const double cosine = std::cos(grazing_rad), sine = std::sin(grazing_rad), slope = std::sqrt(slope2_);
  const std::size_t n = field_.optics().padded();
  double seen_all = 0;
  std::vector<float> sky(n, 0.0f);
  for (const Slope &s : slope_wheel()) {
    const Facet f(slope * s.along, slope * s.across);
    const double incidence = sine * f.z - cosine * f.x;  // cosine between facet and eye
    if (incidence <= 0) continue;
    const double seen = incidence / f.z;
    seen_all += seen;
    const double up = -sine + 2 * incidence * f.z, away = cosine + 2 * incidence * f.x, aside = 2 * incidence * f.y;
    add_sky(sun_altitude_rad, std::max(0.0, std::asin(std::clamp(up, -1.0, 1.0))),
            std::remainder(azimuth_rad + std::atan2(aside, away), 2 * pi),
            static_cast<float>(seen * fresnel_water(incidence)), sky.data());
  }
  if (seen_all <= 0) return;
  for (std::size_t i = 0; i < n; ++i) light[i] += sky[i] / static_cast<float>(seen_all);
}

/// Area of facets that an eye sees, over the level area: sin(grazing) but for the lowest.
double Sea::facets_seen(double grazing_rad) const {
  double seen = 0;
  for (const Slope &s : slope_wheel()) {
    const double slope = std::sqrt(slope2_);
    const Facet f(slope * s.along, slope * s.across);
    seen += std::max(0.0, (std::sin(grazing_rad) * f.z - std::cos(grazing_rad) * f.x) / f.z);
  }
  return seen / static_cast<double>(slope_wheel().size());
}

Sea::Glitter Sea::glitter(const ScatterPath &path, const SunOfStart &sun) const {
  const std::size_t n = path.transmittance.size();
  Glitter g{0, 0, std::vector<float>(n, 0.0f)};
  const SunAtPlace s = sun_at(path.geometry.back(), sun);
  const Sunlight::Look look = field_.sunlight().look(0, s.altitude_rad);
  const double altitude = s.altitude_rad + look.lift_rad;
  if (!has_waves() || path.end != PathEnd::ground || look.dark || altitude <= 0) return g;
  const double grazing = std::max(-path.places.back().elevation_rad, 1e-6);
  g.grazing = std::sin(grazing), g.sun = std::sin(altitude);
  field_.sunlight().share(0, s.altitude_rad, g.strength.data());
  const auto share = static_cast<float>(1 / (4 * facets_seen(grazing)));
  for (std::size_t w = 0; w < n; ++w) g.strength[w] *= share * path.transmittance[w];
  return g;
}

void Sea::add(const ScatterPath &path, const SunOfStart &sun, float *radiance) const {
  const SunAtPlace s = sun_at(path.geometry.back(), sun);
  const std::size_t n = path.transmittance.size();
  std::vector<float> light(n, 0.0f);
  const double from_sun = std::acos(std::clamp(s.sunward / std::max(path.geometry.back().cosine, 1e-9), -1.0, 1.0));
  if (fixed_reflectance_ >= 0)
    add_sky(s.altitude_rad, 10 * deg, from_sun, static_cast<float>(fixed_reflectance_), light.data());
  else mirror(s.altitude_rad, std::max(-path.places.back().elevation_rad, 1e-6), from_sun, light.data());
  for (std::size_t w = 0; w < n; ++w) radiance[w] += path.transmittance[w] * light[w];
}

}  // namespace greenray
