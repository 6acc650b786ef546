#include "sky/scatter.hpp"

#include <algorithm>
#include <cmath>

#include "support/angle.hpp"
#include "support/fast_math.hpp"

namespace greenray {
namespace {

/// Shares of one piece: of its optical depth what is scattered and arrives, half to each end. through: the
/// transmittance up to the piece, which is carried beyond it.
GREENRAY_VECTOR_CLONES
void split_piece(const SkyOptics &optics, const Columns &piece, float *__restrict through, float *__restrict near_air,
                 float *__restrict far_air, float *__restrict near_haze, float *__restrict far_haze) {
  const float air = static_cast<float>(piece.air), ozone = static_cast<float>(piece.ozone),
              haze = static_cast<float>(piece.aerosol), albedo = static_cast<float>(optics.aerosol_albedo);
  const float *r = optics.rayleigh_per_kg_m2.data(), *o = optics.ozone_per_m.data(), *a = optics.aerosol_per_m.data();
  const std::size_t n = optics.padded();
  for (std::size_t w = 0; w < n; ++w) {
    const float by_air = air * r[w], by_haze = haze * a[w];
    const float depth = by_air + by_haze + ozone * o[w], passed = fast_exp_of_negative(-depth);
    // (1 - exp(-t))/t, by its series where the difference would cancel
    const float filled = depth < 0.01f ? 1 - 0.5f * depth * (1 - depth * (1.0f / 3)) : (1 - passed) / depth;
    // light from the far end has more of the piece to pass: its share is what (1 - (1 + t) exp(-t))/t^2 leaves
    const float far = depth < 0.05f ? 0.5f - depth * (1.0f / 3 - depth * (0.125f - depth * (1.0f / 30)))
                                    : (1 - (1 + depth) * passed) / (depth * depth);
    const float near = filled - far, t = through[w];
    near_air[w] += t * by_air * near;
    far_air[w] += t * by_air * far;
    near_haze[w] += t * by_haze * albedo * near;
    far_haze[w] += t * by_haze * albedo * far;
    through[w] = t * passed;
  }
}

/// out += air (even + square c^2) light, out_haze += haze phase light, light = sum of weight x row
GREENRAY_VECTOR_CLONES
void add_once(std::size_t n, const float *__restrict air, const float *__restrict haze, const float *__restrict even,
              const float *__restrict square, float cosine2, float haze_phase, const Sunlight::Look &sun,
              float *__restrict out, float *__restrict out_haze) {
  const float *__restrict r0 = sun.row[0], *__restrict r1 = sun.row[1], *__restrict r2 = sun.row[2],
                          *__restrict r3 = sun.row[3];
  const float w0 = sun.weight[0], w1 = sun.weight[1], w2 = sun.weight[2], w3 = sun.weight[3];
  for (std::size_t w = 0; w < n; ++w) {
    const float light = w0 * r0[w] + w1 * r1[w] + w2 * r2[w] + w3 * r3[w];
    out[w] += air[w] * (even[w] + square[w] * cosine2) * light;
    out_haze[w] += haze[w] * haze_phase * light;
  }
}

GREENRAY_VECTOR_CLONES
void add_diffuse(std::size_t n, const float *__restrict air, const float *__restrict haze, float up3g, float sunward3g,
                 const DiffuseLight::Look &look, float *__restrict out) {
  const float *__restrict r0 = look.row[0], *__restrict r1 = look.row[1], *__restrict r2 = look.row[2],
                          *__restrict r3 = look.row[3];
  const float w0 = look.weight[0], w1 = look.weight[1], w2 = look.weight[2], w3 = look.weight[3];
  for (std::size_t w = 0; w < n; ++w) {
    const std::size_t u = n + w, s = 2 * n + w;
    const float mean = w0 * r0[w] + w1 * r1[w] + w2 * r2[w] + w3 * r3[w];
    const float up = w0 * r0[u] + w1 * r1[u] + w2 * r2[u] + w3 * r3[u];
    const float sunward = w0 * r0[s] + w1 * r1[s] + w2 * r2[s] + w3 * r3[s];
    const float ahead = mean + up3g * up + sunward3g * sunward;
    out[w] += air[w] * mean + haze[w] * (ahead > 0 ? ahead : 0);
  }
}

/// Cosine of the scattering angle: the Sun's direction as it is bent at that place.
double bent_cosine(const SunAtPlace &s, double lift_rad) {
  const double altitude = s.altitude_rad + lift_rad;
  return std::clamp(s.up * std::sin(altitude) + s.sunward * std::cos(altitude), -1.0, 1.0);
}

}  // namespace

SunAtPlace sun_at(const ScatterPath::Place &p, const SunOfStart &sun) {
  const double up = std::clamp(sun.sine * p.turned_cosine + sun.cosine * p.turned_sine * sun.cos_azimuth, -1.0, 1.0);
  const double cosine = sun.sine * p.seen_sine + sun.cosine * p.seen_cosine * sun.cos_azimuth;  // to the line of sight
  return {std::asin(up), p.sine, (cosine - up * p.sine) / std::sqrt(std::max(1e-12, 1 - up * up))};
}

ScatterPath scatter_path(const AirShells &shells, const SkyOptics &optics, const Sunlight &sunlight,
                         const DiffuseLight &diffuse, AirPath path, double elevation_rad) {
  ScatterPath s;
  const std::size_t n = optics.padded();
  s.end = path.end;
  s.places = std::move(path.places);
  s.air.assign(s.places.size() * n, 0.0f);
  s.aerosol.assign(s.places.size() * n, 0.0f);
  s.transmittance.assign(n, 1.0f);
  s.geometry.reserve(s.places.size());
  for (const PathPlace &p : s.places) {
    const double turned = shells.centre_angle_rad(p.along_m), seen = elevation_rad - p.bending_rad;
    s.geometry.push_back({std::sin(p.elevation_rad), std::cos(p.elevation_rad), std::sin(turned), std::cos(turned),
                          std::sin(seen), std::cos(seen), sunlight.at_height(p.height_m),
                          diffuse.at_height(p.height_m)});
  }
  for (std::size_t i = 0; i + 1 < s.places.size(); ++i)
    split_piece(optics, s.places[i + 1].column - s.places[i].column, s.transmittance.data(), &s.air[i * n],
                &s.air[(i + 1) * n], &s.aerosol[i * n], &s.aerosol[(i + 1) * n]);
  return s;
}

void add_scattered(const ScatterPath &path, const SkyOptics &optics, const SkySources &sources, double sun_altitude_rad,
                   double cos_azimuth, float *radiance, float *haze_once) {
  const std::size_t n = optics.padded();
  const auto g = static_cast<float>(optics.aerosol_asymmetry);
  const SunOfStart sun{std::sin(sun_altitude_rad), std::cos(sun_altitude_rad), cos_azimuth};
  for (std::size_t i = 0; i < path.geometry.size(); ++i) {
    const ScatterPath::Place &place = path.geometry[i];
    const SunAtPlace s = sun_at(place, sun);
    const float *air = &path.air[i * n], *haze = &path.aerosol[i * n];
    if (sources.sun) {
      const Sunlight::Look look = sources.sun->look(place.for_sunlight, s.altitude_rad);
      if (!look.dark) {
        const double cosine = bent_cosine(s, look.lift_rad);
        add_once(n, air, haze, optics.rayleigh_even.data(), optics.rayleigh_square.data(),
                 static_cast<float>(cosine * cosine),
                 static_cast<float>(aerosol_phase(cosine, optics.aerosol_asymmetry)), look, radiance,
                 haze_once ? haze_once : radiance);
      }
    }
    if (sources.diffuse)
      add_diffuse(n, air, haze, 3 * g * static_cast<float>(s.up), 3 * g * static_cast<float>(s.sunward),
                  sources.diffuse->look(place.for_diffuse, s.altitude_rad), radiance);
  }
}

void add_lambert_ground(const ScatterPath &path, const Sunlight &sunlight, const SkySources &sources,
                        double sun_altitude_rad, double cos_azimuth, float *radiance) {
  if (sources.ground_albedo <= 0) return;
  const std::size_t n = path.transmittance.size();
  const SunAtPlace s =
      sun_at(path.geometry.back(), {std::sin(sun_altitude_rad), std::cos(sun_altitude_rad), cos_azimuth});
  std::vector<float> light(n, 0.0f), direct(n, 0.0f);
  if (sources.diffuse) sources.diffuse->irradiance(s.altitude_rad, light.data());
  if (sources.sun || !sources.diffuse) {
    sunlight.share(0, s.altitude_rad, direct.data());
    const double lift = sunlight.look(0, s.altitude_rad).lift_rad;
    const auto slant = static_cast<float>(std::max(0.0, std::sin(s.altitude_rad + lift)));
    for (std::size_t w = 0; w < n; ++w) light[w] += slant * direct[w];
  }
  const auto share = static_cast<float>(sources.ground_albedo / pi);
  for (std::size_t w = 0; w < n; ++w) radiance[w] += share * path.transmittance[w] * light[w];
}

}  // namespace greenray
