#include "sky/diffuse_light.hpp"

#include <algorithm>
#include <cmath>

#include "sky/scatter.hpp"
#include "support/angle.hpp"
#include "support/parallel.hpp"

namespace greenray {
namespace {

constexpr double deg = pi / 180;
constexpr int orders_followed = 5, elevations_each = 6, azimuth_count = 5;

std::vector<double> level_heights(double top_m) {
  std::vector<double> h;
  for (double km :
       {0.0, 0.3, 1.0, 2.0, 3.5, 5.5, 8.0, 11.0, 14.0, 17.0, 20.5, 24.5, 29.0, 35.0, 43.0, 54.0, 68.0, 88.0})
    if (1e3 * km < 0.9 * top_m) h.push_back(1e3 * km);
  h.push_back(top_m);
  return h;
}

/// Heights of the shells that lines of sight cross: with one more between those levels between which the Earth's shadow
/// lies in twilight.
std::vector<double> line_heights(const std::vector<double> &levels) {
  std::vector<double> heights;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    heights.push_back(levels[k]);
    if (levels[k] > 3000 && k + 1 < levels.size()) heights.push_back(0.5 * (levels[k] + levels[k + 1]));
  }
  return heights;
}

std::vector<double> sun_altitudes() {
  std::vector<double> rad;
  for (double a : {-24, -20, -17, -14, -12, -10}) rad.push_back(a * deg);
  for (double a = -8; a < 4; a += 1) rad.push_back(a * deg);
  for (double a : {4, 6, 9, 12, 16, 21, 28, 36, 46, 58, 72, 90}) rad.push_back(a * deg);
  return rad;
}

/// Twilight falls by about a factor 3 a degree: what is interpolated is the light over this.
double twilight(double altitude_rad) {
  constexpr double per_rad = 0.48 / deg * 2.302585;  // 0.48 powers of ten a degree
  return altitude_rad < 0 ? std::exp(per_rad * altitude_rad) : 1;
}

/// Gauss and Legendre's places and weights on 0..1.
struct Node {
  double x, weight;
};
std::vector<Node> gauss_nodes(int count) {
  std::vector<Node> nodes;
  for (int i = 0; i < count; ++i) {
    double x = std::cos(pi * (i + 0.75) / (count + 0.5)), slope = 1;
    for (int round = 0; round < 20; ++round) {  // Newton on the Legendre polynomial, by its recurrence
      double before = 1, now = x;
      for (int k = 2; k <= count; ++k) {
        const double next = ((2 * k - 1) * x * now - (k - 1) * before) / k;
        before = now, now = next;
      }
      slope = count * (x * now - before) / (x * x - 1);
      x -= now / slope;
    }
    nodes.push_back({0.5 * (1 + x), 1 / ((1 - x * x) * slope * slope)});
  }
  return nodes;
}

/// Directions of a level: elevations crowd at its horizon, where the air is brightest. Weights sum to the share of the
/// sphere's 1 that lies on either side of the horizon.
struct Elevation {
  double rad, weight;
};
std::vector<Elevation> elevations(double horizon_rad) {
  const double edge = std::sin(horizon_rad);
  std::vector<Elevation> all;
  for (const Node &n : gauss_nodes(elevations_each)) {  // sin e = edge + (1 - edge) x^2
    all.push_back({std::asin(edge + (1 - edge) * n.x * n.x), (1 - edge) * n.x * n.weight});
    all.push_back({std::asin(edge - (1 + edge) * n.x * n.x), (1 + edge) * n.x * n.weight});
  }
  return all;
}

/// Azimuths over half a turn, crowded towards the Sun, where haze is brightest. Weights sum to 1.
struct Azimuth {
  double cosine, weight;
};
std::vector<Azimuth> azimuths() {
  std::vector<Azimuth> all;
  for (const Node &n : gauss_nodes(azimuth_count)) all.push_back({std::cos(pi * n.x * n.x), 2 * n.x * n.weight});
  return all;
}

}  // namespace

/// One line of sight of a level: its places with the shares of air and aerosol that they scatter to its start.
struct DiffuseLight::Line {
  double elevation_rad, weight;
  ScatterPath path;
};

/// The sequence of orders while it is computed.
struct DiffuseLight::Orders {
  const DiffuseLight &light;
  const AirShells &shells;
  const SkyOptics &optics;
  const Sunlight &sunlight;
  double albedo;
  std::vector<std::vector<Line>> lines = {};  // by level
  std::vector<Azimuth> azimuths_seen = azimuths();

  void trace_lines() {
    lines.resize(light.height_m_.size());
    for (std::size_t k = 0, at = 0; k < lines.size(); ++k) {
      while (shells.height_m(at) < light.height_m_[k]) ++at;
      for (const Elevation &e : elevations(shells.lowest_clear_rad(at)))
        lines[k].push_back(
            {e.rad, e.weight, scatter_path(shells, optics, sunlight, light, shells.path(at, e.rad, 2e6), e.rad)});
    }
  }

  /// Light of the next order at one level and altitude of the Sun. before: the order before; null: sunlight itself.
  void gather(std::size_t level, std::size_t sun, const DiffuseLight *before, float *moments, float *irradiance) const {
    const std::size_t n = light.padded_;
    std::vector<float> radiance(n);
    for (const Line &line : lines[level])
      for (const auto &[cos_azimuth, share] : azimuths_seen) {
        std::fill(radiance.begin(), radiance.end(), 0.0f);
        const SkySources sources{before ? nullptr : &sunlight, before, albedo};
        add_scattered(line.path, optics, sources, light.sun_rad_[sun], cos_azimuth, radiance.data());
        if (line.path.end == PathEnd::ground)
          add_lambert_ground(line.path, sunlight, sources, light.sun_rad_[sun], cos_azimuth, radiance.data());
        const auto weight = static_cast<float>(line.weight * share);
        const auto up = static_cast<float>(std::sin(line.elevation_rad));
        const auto sunward = static_cast<float>(std::cos(line.elevation_rad) * cos_azimuth);
        for (std::size_t w = 0; w < n; ++w) {
          const float part = weight * radiance[w];
          moments[w] += part;
          moments[n + w] += part * up;
          moments[2 * n + w] += part * sunward;
          if (up > 0 && irradiance) irradiance[w] += static_cast<float>(4 * pi) * part * up;
        }
      }
  }
};

DiffuseLight::DiffuseLight(const LayeredMedium &medium, double wavelength_nm, const LayerAbsorbers &absorbers,
                           const SkyOptics &optics, const Sunlight &sunlight, double ground_albedo)
    : padded_(optics.padded()),
      height_m_(level_heights(medium.top_m)),
      sun_rad_(sun_altitudes()),
      radius_m_(medium.radius_m) {
  for (double height : height_m_.nodes())
    for (double altitude : sun_rad_.nodes()) scale_.push_back(twilight(altitude - at_height(height).horizon_rad));
  const AirShells shells(medium, wavelength_nm, absorbers, line_heights(height_m_.nodes()));
  Orders orders{*this, shells, optics, sunlight, ground_albedo};
  orders.trace_lines();
  const std::size_t suns = sun_rad_.size();
  field_.assign(height_m_.size() * suns * 3 * padded_, 0.0f);
  irradiance_.assign(suns * padded_, 0.0f);
  std::vector<float> all(field_.size()), all_irradiance(irradiance_.size()), before;
  for (int order = 1; order <= orders_followed; ++order) {
    std::vector<float> next(field_.size()), next_irradiance(irradiance_.size());
    for_pieces(height_m_.size(), 1, host_threads(), [&](std::size_t first, std::size_t last) {
      for (std::size_t k = first; k < last; ++k)
        for (std::size_t s = 0; s < suns; ++s)
          orders.gather(k, s, order == 1 ? nullptr : this, &next[index(k, s)],
                        k == 0 ? &next_irradiance[s * padded_] : nullptr);
    });
    double mean = 0;
    for (std::size_t i = 0; i < next.size(); ++i) all[i] += next[i];
    for (std::size_t i = 0; i < next_irradiance.size(); ++i) all_irradiance[i] += next_irradiance[i];
    for (std::size_t i = 0; i < next.size(); i += 3 * padded_)
      for (std::size_t w = 0; w < padded_; ++w) mean += next[i + w];
    orders_.push_back(mean);
    before = std::move(field_);
    field_ = std::move(next);
    if (order == orders_followed) {
      add_tail(next_irradiance, irradiance_, all_irradiance);
      add_tail(field_, before, all);
    }
    irradiance_ = std::move(next_irradiance);
  }
  field_ = std::move(all);
  irradiance_ = std::move(all_irradiance);
}

/// The orders that were not followed: as if each were to the one before as the last two are, by wavelength.
void DiffuseLight::add_tail(const std::vector<float> &last, const std::vector<float> &before,
                            std::vector<float> &sum) const {
  std::vector<double> now(padded_), then(padded_);
  for (std::size_t i = 0; i < last.size(); ++i) {
    now[i % padded_] += std::abs(last[i]);
    then[i % padded_] += std::abs(before[i]);
  }
  for (std::size_t i = 0; i < last.size(); ++i) {
    const double ratio = then[i % padded_] > 0 ? std::min(now[i % padded_] / then[i % padded_], 0.95) : 0;
    sum[i] += static_cast<float>(last[i] * ratio / (1 - ratio));
  }
}

DiffuseLight::Height DiffuseLight::at_height(double height_m) const {
  const double dip = radius_m_ > 0 ? std::acos(radius_m_ / (radius_m_ + std::max(height_m, 0.0))) : 0;
  return {height_m_.find(height_m), -dip};
}

DiffuseLight::Look DiffuseLight::look(const Height &height, double altitude_rad) const {
  const Axis::Place sun = sun_rad_.find(altitude_rad);
  const double scale = twilight(std::max(altitude_rad, sun_rad_.front()) - height.horizon_rad);
  const std::size_t k = height.level.cell, j = sun.cell, suns = sun_rad_.size();
  const double t = height.level.fraction, s = sun.fraction;
  const std::array<double, 4> weights{(1 - t) * (1 - s), (1 - t) * s, t * (1 - s), t * s};
  const std::array<std::size_t, 4> cells{k * suns + j, k * suns + j + 1, (k + 1) * suns + j, (k + 1) * suns + j + 1};
  Look look{};
  for (std::size_t i = 0; i < 4; ++i) {
    look.row[i] = &field_[cells[i] * 3 * padded_];
    look.weight[i] = static_cast<float>(weights[i] * scale / scale_[cells[i]]);
  }
  return look;
}

void DiffuseLight::irradiance(double altitude_rad, float *irradiance) const {
  const Axis::Place sun = sun_rad_.find(altitude_rad);
  const double scale = twilight(std::max(altitude_rad, sun_rad_.front()));
  const auto here = static_cast<float>((1 - sun.fraction) * scale / scale_[sun.cell]);
  const auto next = static_cast<float>(sun.fraction * scale / scale_[sun.cell + 1]);
  const float *a = &irradiance_[sun.cell * padded_], *b = a + padded_;
  for (std::size_t w = 0; w < padded_; ++w) irradiance[w] = here * a[w] + next * b[w];
}

}  // namespace greenray
