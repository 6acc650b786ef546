// An independent tracer of light: double, brute force, straight paths, one wavelength, spots, Lambert surfaces and
// smooth glass. Shares with the engine the scene as it was read, and nothing else.
#pragma once
#include <cmath>
#include <functional>
#include <random>

#include "scene/room_scene.hpp"
#include "support_code/surfaces.hpp"

namespace greenray {

/* Arvo 1986: packets of equal power leave the spots, are bent and split by glass (Snell; Fresnel as a probability),
   and go on from Lambert surfaces with the probability of the albedo. */
class LightTracer {
 public:
  /// place, facing normal, power
  using Land = std::function<void(const Triple &, const Triple &, double)>;
  LightTracer(const RoomScene &scene, double wavelength_nm) : scene_(scene), wavelength_nm_(wavelength_nm) {}

  void trace(int packets, std::mt19937_64 &engine, const Land &land) const {
    for (const LightScene &light : scene_.lights)
      for (int i = 0; i < packets; ++i) follow(light, light.power_W / packets, engine, land);
  }

  Triple normal_at(int primitive, const Triple &place) const {
    const auto i = static_cast<std::size_t>(primitive), triangles = scene_.surfaces.triangles.size();
    if (i < triangles) return unit(scene_.surfaces.triangles[i].area_vector_m2());
    return unit(place - scene_.surfaces.spheres[i - triangles].centre);
  }
  const MaterialScene &material_at(int primitive) const {
    const auto i = static_cast<std::size_t>(primitive), triangles = scene_.surfaces.triangles.size();
    const int m =
        i < triangles ? scene_.surfaces.triangles[i].material : scene_.surfaces.spheres[i - triangles].material;
    return scene_.materials[static_cast<std::size_t>(m)];
  }

 private:
  void follow(const LightScene &light, double power, std::mt19937_64 &engine, const Land &land) const {
    Triple place = light.from, direction = in_cone(light, engine);
    for (int bounce = 0; bounce < 1000; ++bounce) {
      const Met met = brute_force(scene_.surfaces, place, direction, 1e30, 0).certain;
      if (met.primitive < 0) return;
      const Triple at = place + met.sigma * direction;
      Triple normal = normal_at(met.primitive, at);
      const bool outside = dot(normal, direction) < 0;
      if (!outside) normal = -1.0 * normal;
      const MaterialScene &material = material_at(met.primitive);
      if (material.kind == MaterialScene::Kind::dielectric) {
        const double n = material.index.at(wavelength_nm_);
        direction = through_glass(direction, normal, outside ? n : 1 / n, engine);
      } else {
        land(at, normal, power);
        if (!(uniform_(engine) < material.reflectance.rgb[0])) return;
        direction = cosine_about(normal, engine);
      }
      place = at + (dot(normal, direction) > 0 ? 1e-9 : -1e-9) * normal;
    }
  }

  /// Born & Wolf 1.5: amplitudes of both polarisations, here by the angles' sines and tangents.
  Triple through_glass(const Triple &d, const Triple &normal, double index, std::mt19937_64 &engine) const {
    const double cosine = -dot(d, normal), sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const Triple mirror = d + (2 * cosine) * normal;
    if (sine >= index) return mirror;
    const double in = std::asin(sine), out = std::asin(sine / index);
    double reflected = std::pow((index - 1) / (index + 1), 2);
    if (in > 1e-4)
      reflected = 0.5 * (std::pow(std::sin(in - out) / std::sin(in + out), 2) +
                         std::pow(std::tan(in - out) / std::tan(in + out), 2));
    if (uniform_(engine) < reflected) return mirror;
    const Triple across = unit(d + cosine * normal);
    return sine < 1e-12 ? d : std::sin(out) * across - std::cos(out) * normal;
  }

  Triple in_cone(const LightScene &light, std::mt19937_64 &engine) const {
    const double half = light.cone_deg * M_PI / 360, c = 1 - uniform_(engine) * (1 - std::cos(half));
    const double phi = 2 * M_PI * uniform_(engine), s = std::sqrt(1 - c * c);
    const Triple side =
        unit(cross(light.direction, std::abs(light.direction[0]) < 0.5 ? Triple{1, 0, 0} : Triple{0, 1, 0}));
    return c * light.direction + (s * std::cos(phi)) * side + (s * std::sin(phi)) * cross(light.direction, side);
  }

  Triple cosine_about(const Triple &normal, std::mt19937_64 &engine) const {
    std::normal_distribution<double> gauss;
    Triple d{};
    do d = normal + unit({gauss(engine), gauss(engine), gauss(engine)});
    while (length(d) < 1e-6);
    return unit(d);
  }

  const RoomScene &scene_;
  double wavelength_nm_;
  mutable std::uniform_real_distribution<double> uniform_{0, 1};
};

}  // namespace greenray
