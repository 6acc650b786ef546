// An independent path tracer: double, brute force, straight paths, one wavelength, Lambert surfaces, area lights and
// spots. Shares with the engine the scene as it was read, and nothing else.
#pragma once
#include <cmath>
#include <random>

#include "scene/room_scene.hpp"
#include "support_code/surfaces.hpp"

namespace greenray {

/* Unidirectional path tracing with next-event estimation (Kajiya 1986; Shirley, Wang, Zimmerman 1996): at each place on
   a Lambert surface one point of each light is asked for directly, so lamps that are met by chance count only at the
   first hit. Radiance per unit of spectral power: a light's power_W is taken as its power at the one wavelength. */
class PathTracer {
 public:
  /// albedo: of each material at the wavelength
  PathTracer(const RoomScene &scene, std::vector<double> albedo) : scene_(scene), albedo_(std::move(albedo)) {
    area_.assign(scene.lights.size(), 0.0);
    for (const Triangle &t : scene.surfaces.triangles)
      if (t.light >= 0) area_[static_cast<std::size_t>(t.light)] += length(t.area_vector_m2());
  }

  double radiance(Triple place, Triple direction, std::mt19937_64 &engine) const {
    double seen = 0, weight = 1;
    for (int bounce = 0; bounce < 400; ++bounce) {
      const Met met = brute_force(scene_.surfaces, place, direction, 1e30, 0).certain;
      if (met.primitive < 0) return seen;
      const Triangle &t = scene_.surfaces.triangles[static_cast<std::size_t>(met.primitive)];
      const Triple outside = unit(t.area_vector_m2());
      const bool front = dot(outside, direction) < 0;
      if (bounce == 0 && front && t.light >= 0) seen += emitted(t.light);
      const Triple normal = front ? outside : -1.0 * outside;
      place = place + met.sigma * direction + 1e-9 * normal;
      const double albedo = albedo_[static_cast<std::size_t>(t.material)];
      if (!(uniform_(engine) < albedo)) return seen;  // survivors carry their whole weight
      for (std::size_t l = 0; l < scene_.lights.size(); ++l)
        seen += weight / M_PI * irradiance(static_cast<int>(l), place, normal, engine);
      direction = cosine_about(normal, engine);
    }
    return seen;
  }

  bool shows_lamp(const Triple &place, const Triple &direction) const {
    const int met = brute_force(scene_.surfaces, place, direction, 1e30, 0).certain.primitive;
    return met >= 0 && scene_.surfaces.triangles[static_cast<std::size_t>(met)].light >= 0;
  }

 private:
  double emitted(int light) const {
    const auto l = static_cast<std::size_t>(light);
    return scene_.lights[l].power_W / (M_PI * area_[l]);
  }

  bool sees(const Triple &from, const Triple &to) const {
    return brute_force(scene_.surfaces, from, to - from, 1 - 1e-7, 0).certain.primitive < 0;
  }

  /// One sample of the irradiance from a light.
  double irradiance(int light, const Triple &place, const Triple &normal, std::mt19937_64 &engine) const {
    const LightScene &l = scene_.lights[static_cast<std::size_t>(light)];
    if (l.kind == LightScene::Kind::area) return from_area(light, place, normal, engine);
    const Triple to = l.from - place;
    const double distance = length(to), cosine = dot(normal, to) / distance;
    const double half = l.cone_deg * M_PI / 360, away = -dot(l.direction, to) / distance;
    if (cosine <= 0 || away < std::cos(half) || !sees(place, l.from)) return 0;
    return l.power_W / (2 * M_PI * (1 - std::cos(half))) * cosine / (distance * distance);
  }

  double from_area(int light, const Triple &place, const Triple &normal, std::mt19937_64 &engine) const {
    double pick = uniform_(engine) * area_[static_cast<std::size_t>(light)];
    for (const Triangle &t : scene_.surfaces.triangles) {
      if (t.light != light) continue;
      const double area = length(t.area_vector_m2());
      if ((pick -= area) > 0) continue;
      const double side = std::sqrt(uniform_(engine)), v = uniform_(engine);
      const Triple on =
          t.corner[0] + side * (1 - v) * (t.corner[1] - t.corner[0]) + side * v * (t.corner[2] - t.corner[0]);
      const Triple to = on - place;
      const double distance = length(to), cosine = dot(normal, to) / distance;
      const double lamp_cosine = -dot(unit(t.area_vector_m2()), to) / distance;
      if (cosine <= 0 || lamp_cosine <= 0 || !sees(place, on)) return 0;
      return emitted(light) * cosine * lamp_cosine / (distance * distance) * area_[static_cast<std::size_t>(light)];
    }
    return 0;
  }

  Triple cosine_about(const Triple &normal, std::mt19937_64 &engine) const {
    // A point on the unit sphere about the tip of the normal.
    std::normal_distribution<double> gauss;
    Triple d{};
    do d = normal + unit({gauss(engine), gauss(engine), gauss(engine)});
    while (length(d) < 1e-6);
    return unit(d);
  }

  const RoomScene &scene_;
  std::vector<double> albedo_, area_;
  mutable std::uniform_real_distribution<double> uniform_{0, 1};
};

}  // namespace greenray
