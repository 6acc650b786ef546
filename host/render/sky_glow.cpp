#include "render/sky_glow.hpp"

#include <algorithm>
#include <cmath>

#include "support/angle.hpp"
#include "support/parallel.hpp"

namespace greenray {
namespace {

constexpr double tolerance = 0.002;        // of interpolation, relative
constexpr double faint = 1e-3;             // of the brightest: what is fainter may be wrong by that
constexpr std::size_t most_azimuths = 17;  // 2^4 + 1: each number's places hold those of half as many
constexpr double finest_rad = 1e-6;

}  // namespace

SkyOptics sky_optics(const AtmosphereScene &air, const std::vector<SpectralAir> &spectral,
                     const std::vector<double> &wavelength_nm) {
  SkyOptics o;
  o.wavelength_nm = wavelength_nm;
  o.aerosol_albedo = air.aerosol_scattering_albedo;
  o.aerosol_asymmetry = air.aerosol_asymmetry;
  const std::size_t padded = (wavelength_nm.size() + spectral_group - 1) / spectral_group * spectral_group;
  for (std::size_t w = 0; w < padded; ++w) {
    const std::size_t at = std::min(w, wavelength_nm.size() - 1);
    const SpectralAir &a = spectral[at];
    const RayleighPhase phase = rayleigh_phase(rayleigh_anisotropy(wavelength_nm[at]));
    o.rayleigh_per_kg_m2.push_back(static_cast<float>(a.rayleigh_per_kg_m2));
    o.ozone_per_m.push_back(static_cast<float>(a.ozone_per_m));
    o.aerosol_per_m.push_back(static_cast<float>(a.aerosol_per_m));
    o.rayleigh_even.push_back(static_cast<float>(phase.even));
    o.rayleigh_square.push_back(static_cast<float>(phase.square));
  }
  return o;
}

std::shared_ptr<const SkyField> sky_field(const Scene &scene, const Profile &air,
                                          const std::vector<SpectralAir> &spectral,
                                          const std::vector<double> &wavelength_nm) {
  SkyFieldOptions options;
  options.eye_m = scene.observer.height_m;
  options.ground_albedo = scene.sky.ground_albedo;
  const LayerAbsorbers absorbers{ozone_peak_m, ozone_width_m, scene.atmosphere.aerosol_scale_height_m};
  return std::make_shared<SkyField>(layered_medium(air, scene.atmosphere.surface == Surface::flat), absorbers,
                                    sky_optics(scene.atmosphere, spectral, wavelength_nm), options);
}

SkyGlow::SkyGlow(std::shared_ptr<const SkyField> field, const SkyScene &sky, double sun_altitude_rad,
                 std::vector<double> irradiance, const GlowRange &range)
    : field_(std::move(field)), sun_altitude_rad_(sun_altitude_rad), irradiance_(std::move(irradiance)) {
  irradiance_.resize(padded(), irradiance_.back());
  near_ = std::pow(std::sin(range.nearest_rad / 2), 2);
  far_ = std::max(std::pow(std::sin(range.farthest_rad / 2), 2), near_ + 1e-9);
  const AirShells &shells = field_->shells();
  if (sky.surface == SkyScene::Surface::sea) {
    // The horizon's distance is how far the Sun's altitude on the sea may differ from that at the eye.
    const double horizon = shells.radius_m() > 0 ? -shells.lowest_clear_rad(field_->eye_level()) : 0;
    std::vector<double> suns{sun_altitude_rad};
    if (horizon > to_rad(0.1)) suns = {sun_altitude_rad - horizon, sun_altitude_rad, sun_altitude_rad + horizon};
    sea_.emplace(*field_, suns, sky.wind_m_s, sky.sea_reflectance.value_or(-1));
  }
  choose_azimuths(range);
  std::vector<double> edges{range.low_rad};
  for (double e : shells.breaks_rad(field_->eye_level()))
    if (e > range.low_rad && e < range.high_rad) edges.push_back(e);
  edges.push_back(range.high_rad);
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const double beside = std::min(1e-9, 0.01 * (edges[i + 1] - edges[i]));
    const double low = edges[i] + (i > 0 ? beside : 0), high = edges[i + 1] - (i + 2 < edges.size() ? beside : 0);
    const PathEnd end = shells.exit(field_->eye_level(), 0.5 * (low + high)).end;
    intervals_.push_back({low, high, end == PathEnd::space, {}, {}});
  }
  for_pieces(intervals_.size(), 1, host_threads(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) fill(intervals_[i]);
  });
}

/// Chebyshev's extreme points between the nearest and the farthest; one: the middle.
std::vector<double> SkyGlow::azimuth_places(std::size_t count) const {
  if (count == 1) return {0.5 * (near_ + far_)};
  std::vector<double> places;
  for (std::size_t m = 0; m < count; ++m) {
    const double x = -std::cos(pi * static_cast<double>(m) / static_cast<double>(count - 1));
    places.push_back(std::clamp(near_ + 0.5 * (far_ - near_) * (1 + x), near_, far_));
  }
  return places;
}

/// Radiance at one elevation at places sin^2(azimuth/2), in the two parts of the kernel's channels.
std::vector<float> SkyGlow::rows(double elevation_rad, const std::vector<double> &places) const {
  const SkyOptics &optics = field_->optics();
  const std::size_t n = padded();
  std::vector<float> rows((first_azimuth + 2 * places.size()) * n, 0.0f);
  const ScatterPath path = field_->line_of_sight(elevation_rad);
  const double sine = std::sin(sun_altitude_rad_), cosine = std::cos(sun_altitude_rad_);
  const double seen = elevation_rad - path.places.back().bending_rad;  // as the kernel has the direction
  for (std::size_t m = 0; m < places.size(); ++m) {
    float *glow = &rows[(first_azimuth + 2 * m) * n], *aureole = glow + n;
    const SunOfStart sun{sine, cosine, 1 - 2 * places[m]};
    add_scattered(path, optics, field_->sources(), sun_altitude_rad_, sun.cos_azimuth, glow, aureole);
    if (path.end == PathEnd::ground) {
      if (sea_) sea_->add(path, sun, glow);
      else add_lambert_ground(path, field_->sunlight(), field_->sources(), sun_altitude_rad_, sun.cos_azimuth, glow);
    }
    const double towards = sine * std::sin(seen) + cosine * std::cos(seen) * sun.cos_azimuth;
    const double phase = aerosol_phase(std::min(towards, 1.0), optics.aerosol_asymmetry);
    for (std::size_t w = 0; w < n; ++w) {
      glow[w] *= static_cast<float>(irradiance_[w]);
      aureole[w] *= static_cast<float>(irradiance_[w] / phase);
    }
  }
  if (sea_ && path.end == PathEnd::ground) {
    const Sea::Glitter g = sea_->glitter(path, {sine, cosine, 1 - 2 * places.front()});
    for (std::size_t w = 0; w < n; ++w) {
      rows[w] = g.strength[w] * static_cast<float>(irradiance_[w]);
      rows[n + w] = static_cast<float>(g.grazing);
      rows[2 * n + w] = static_cast<float>(g.sun);
    }
  }
  return rows;
}

/// The fewest azimuths that give those between them.
void SkyGlow::choose_azimuths(const GlowRange &range) {
  constexpr int probes = 5;
  const std::vector<double> all = azimuth_places(most_azimuths);
  const std::size_t n = padded();
  std::vector<std::vector<float>> truth;
  for (int i = 0; i < probes; ++i)
    truth.push_back(rows(range.low_rad + (range.high_rad - range.low_rad) * (i + 0.5) / probes, all));
  for (azimuths_ = 1; azimuths_ < most_azimuths; azimuths_ = azimuths_ == 1 ? 2 : 2 * azimuths_ - 1) {
    const std::vector<double> nodes = azimuth_places(azimuths_);
    const std::size_t stride = (most_azimuths - 1) / std::max<std::size_t>(azimuths_ - 1, 1);
    const std::size_t first = azimuths_ == 1 ? (most_azimuths - 1) / 2 : 0;  // the node of one, among all
    azimuth_error_ = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (azimuths_ == 1 ? k == first : k % stride == 0) continue;
      std::vector<double> weights(azimuths_, 1);
      for (std::size_t m = 0; m < azimuths_; ++m)
        for (std::size_t j = 0; j < azimuths_; ++j)
          if (j != m) weights[m] *= (all[k] - nodes[j]) / (nodes[m] - nodes[j]);
      for (const std::vector<float> &row : truth)
        for (std::size_t c = first_azimuth * n; c < (first_azimuth + 2) * n; ++c) {
          double sum = 0, largest = 0;
          for (std::size_t m = 0; m < azimuths_; ++m) sum += weights[m] * row[2 * (first + m * stride) * n + c];
          for (std::size_t j = 0; j < all.size(); ++j) largest = std::max<double>(largest, row[2 * j * n + c]);
          const double is = row[2 * k * n + c];
          if (largest > 0) azimuth_error_ = std::max(azimuth_error_, std::abs(sum - is) / (is + faint * largest));
        }
    }
    if (azimuth_error_ <= tolerance) return;
  }
}

void SkyGlow::fill(Interval &interval) const {
  const std::vector<double> places = azimuth_places(azimuths_);
  const std::vector<float> first = rows(interval.low_rad, places), last = rows(interval.high_rad, places);
  interval.elevation_rad = {interval.low_rad};
  interval.rows = first;
  refine(interval.low_rad, interval.high_rad, first, last, interval, 0);
}

/// Halves from low to high until the middle is what a straight line says; appends all but the first.
void SkyGlow::refine(double low, double high, const std::vector<float> &at_low, const std::vector<float> &at_high,
                     Interval &interval, int depth) const {
  constexpr int least_depth = 2, most_depth = 16;
  const double middle = 0.5 * (low + high);
  std::vector<float> at_middle;
  bool good = high - low < finest_rad || depth >= most_depth;
  if (!good) {
    at_middle = rows(middle, azimuth_places(azimuths_));
    good = depth >= least_depth || high - low < to_rad(0.02);
    float largest = 0;
    for (std::size_t i = first_azimuth * padded(); i < at_middle.size(); ++i) largest = std::max(largest, at_middle[i]);
    for (std::size_t i = 0; i < at_middle.size() && good; ++i)
      good = std::abs(0.5f * (at_low[i] + at_high[i]) - at_middle[i]) <=
             static_cast<float>(2 * tolerance) * (at_middle[i] + static_cast<float>(faint) * largest);
  }
  if (!good) {
    refine(low, middle, at_low, at_middle, interval, depth + 1);
    refine(middle, high, at_middle, at_high, interval, depth + 1);
    return;
  }
  if (!at_middle.empty()) {
    interval.elevation_rad.push_back(middle);
    interval.rows.insert(interval.rows.end(), at_middle.begin(), at_middle.end());
  }
  interval.elevation_rad.push_back(high);
  interval.rows.insert(interval.rows.end(), at_high.begin(), at_high.end());
}

SkyGlow::Place SkyGlow::find(double elevation_rad, bool to_space) const {
  const Interval *best = nullptr;
  double nearest = 1e9;
  for (const Interval &i : intervals_) {
    const double away = std::max({0.0, i.low_rad - elevation_rad, elevation_rad - i.high_rad});
    const double cost = away + (i.to_space == to_space ? 0 : 100);  // the like first, however far
    if (cost < nearest) nearest = cost, best = &i;
  }
  const std::vector<double> &e = best->elevation_rad;
  const std::size_t row = row_count() * padded();
  const auto next = std::upper_bound(e.begin(), e.end(), elevation_rad);
  const auto k = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(next - e.begin() - 1, 0, static_cast<std::ptrdiff_t>(e.size()) - 2));
  const double t = std::clamp((elevation_rad - e[k]) / std::max(e[k + 1] - e[k], 1e-300), 0.0, 1.0);
  return {&best->rows[k * row], &best->rows[(k + 1) * row], static_cast<float>(t)};
}

SkyGlow::AirBefore SkyGlow::air_before(double distance_m) const {
  const SkyOptics &optics = field_->optics();
  const std::size_t n = padded();
  AirBefore air;
  for (const Interval &i : intervals_)
    air.elevation_rad.insert(air.elevation_rad.end(), i.elevation_rad.begin(), i.elevation_rad.end());
  air.rows.assign(air.elevation_rad.size() * 2 * n, 0.0f);
  const SunOfStart sun{std::sin(sun_altitude_rad_), std::cos(sun_altitude_rad_), 1 - (near_ + far_)};
  for_pieces(air.elevation_rad.size(), 8, host_threads(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const double e = air.elevation_rad[i];
      const ScatterPath path = field_->line_of_sight(e, distance_m / std::max(std::cos(e), 1e-6));
      float *glow = &air.rows[2 * i * n], *aureole = glow + n;
      add_scattered(path, optics, field_->sources(), sun_altitude_rad_, sun.cos_azimuth, glow, aureole);
      const double seen = e - path.places.back().bending_rad;
      const double towards = sun.sine * std::sin(seen) + sun.cosine * std::cos(seen) * sun.cos_azimuth;
      const double phase = aerosol_phase(std::min(towards, 1.0), optics.aerosol_asymmetry);
      for (std::size_t w = 0; w < n; ++w) {
        glow[w] *= static_cast<float>(irradiance_[w]);
        aureole[w] *= static_cast<float>(irradiance_[w] / phase);
      }
    }
  });
  return air;
}

}  // namespace greenray
