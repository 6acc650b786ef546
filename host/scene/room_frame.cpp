#include "scene/room_frame.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace greenray {
namespace {

constexpr double most_m = 1e7, least_m = 1e-6, most_sizes = 20000;
constexpr std::size_t most_materials = 32766;  // two numbers of glasses fit an int

struct Reach {
  Triple low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  void include(const Triple &p, double r = 0) {
    for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], p[a] - r), high[a] = std::max(high[a], p[a] + r);
  }
  double size_m() const { return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}); }
  double farthest_m() const {
    double most = 0;
    for (std::size_t a = 0; a < 3; ++a) most = std::max({most, std::abs(low[a]), std::abs(high[a])});
    return most;
  }
};

Reach reach_of(const Surfaces &surfaces) {
  Reach reach;
  for (const Triangle &t : surfaces.triangles)
    for (const Triple &corner : t.corner) reach.include(corner);
  for (const Sphere &s : surfaces.spheres) reach.include(s.centre, s.radius_m);
  return reach;
}

bool has_place(const LightScene &light) {
  return light.kind == LightScene::Kind::point || light.kind == LightScene::Kind::spot;
}

void move(RoomScene &scene, const Triple &by) {
  for (Triangle &t : scene.surfaces.triangles)
    for (Triple &corner : t.corner) corner = corner + by;
  for (Sphere &s : scene.surfaces.spheres) s.centre = s.centre + by;
  for (LightScene &light : scene.lights)
    if (has_place(light)) light.from = light.from + by;
  scene.camera.from = scene.camera.from + by, scene.camera.to = scene.camera.to + by;
}

std::string in_m(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g m", value);
  return text;
}

void check_reach(const RoomScene &scene) {
  Reach reach = reach_of(scene.surfaces);
  const double size = reach.size_m();
  reach.include(scene.camera.from);
  for (const LightScene &light : scene.lights)
    if (has_place(light)) reach.include(light.from);
  const double far = reach.farthest_m();
  const SourcePlace place{scene.file, 1, 1};
  if (scene.materials.size() > most_materials)
    throw InputError(place, "expected at most " + std::to_string(most_materials) + " materials, found " +
                                std::to_string(scene.materials.size()));
  if (!(size >= least_m)) throw InputError(place, "expected surfaces of a micrometre or more, found " + in_m(size));
  if (!(far <= most_m)) throw InputError(place, "expected everything within 1e7 m, found " + in_m(far));
  if (far > most_sizes * size)
    throw InputError(place, "expected surfaces, camera and lights within 20000 times the size of the scene (" +
                                in_m(size) + ") from its origin, found " + in_m(far) +
                                ": single precision cannot tell places apart there");
}

bool is_glass(const MaterialScene &m) {
  return m.kind == MaterialScene::Kind::dielectric || m.kind == MaterialScene::Kind::rough_dielectric;
}

/// Distance along a unit direction, infinite where it is missed. source: Moller & Trumbore 1997
double way_to(const Triangle &t, const Triple &from, const Triple &d) {
  const Triple side = t.corner[1] - t.corner[0], other = t.corner[2] - t.corner[0], p = cross(d, other);
  const double det = dot(side, p);
  if (det == 0) return INFINITY;
  const Triple s = from - t.corner[0], q = cross(s, side);
  const double u = dot(s, p) / det, v = dot(d, q) / det, way = dot(other, q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && way > 0 ? way : INFINITY;
}

/// A crossing of a glass surface: how far, of which material, from behind or not.
struct Crossing {
  double way;
  int material;
  bool from_behind;
};

void add_crossings(const RoomScene &scene, const Triple &from, const Triple &d, std::vector<Crossing> &all) {
  const auto glass_of = [&](int material) { return is_glass(scene.materials[static_cast<std::size_t>(material)]); };
  for (const Triangle &t : scene.surfaces.triangles) {
    if (!glass_of(t.material)) continue;
    const double way = way_to(t, from, d);
    if (way < INFINITY) all.push_back({way, t.material, dot(t.area_vector_m2(), d) > 0});
  }
  for (const Sphere &s : scene.surfaces.spheres) {
    if (!glass_of(s.material)) continue;
    const Triple to = s.centre - from;
    const double along = dot(to, d), square = s.radius_m * s.radius_m - dot(to, to) + along * along;
    if (square <= 0) continue;
    const double half = std::sqrt(square);
    if (along - half > 0) all.push_back({along - half, s.material, false});
    if (along + half > 0) all.push_back({along + half, s.material, true});
  }
}

/// The innermost two of the glasses that are left along a direction without having been entered on it.
int glass_along(const RoomScene &scene, const Triple &from, const Triple &d) {
  std::vector<Crossing> crossings;
  add_crossings(scene, from, d, crossings);
  std::sort(crossings.begin(), crossings.end(), [](const Crossing &a, const Crossing &b) { return a.way < b.way; });
  std::vector<int> entered, around;
  for (const Crossing &c : crossings) {
    if (!c.from_behind) entered.push_back(c.material);
    else if (const auto of = std::find(entered.rbegin(), entered.rend(), c.material); of != entered.rend())
      entered.erase(std::next(of).base());
    else around.push_back(c.material + 1);
  }
  return around.empty() ? 0 : around.size() == 1 ? around[0] : around[0] | around[1] << 16;
}

}  // namespace

RoomScene moved_to_middle(RoomScene scene) {
  const Reach reach = reach_of(scene.surfaces);
  const bool height_matters =
      scene.air || std::any_of(scene.lights.begin(), scene.lights.end(), [](const auto &l) { return l.through_air; });
  Triple by{};
  for (std::size_t a = 0; a < (height_matters ? 2u : 3u); ++a) {
    const double middle = 0.5 * (reach.low[a] + reach.high[a]);
    if (std::abs(middle) > reach.size_m()) by[a] = -middle;
  }
  if (by != Triple{}) move(scene, by);
  check_reach(scene);
  return scene;
}

int glass_around(const RoomScene &scene, const Triple &place) {
  if (std::none_of(scene.materials.begin(), scene.materials.end(), is_glass)) return 0;
  int found[3], i = 0;
  for (const Triple &d :
       {Triple{0.2672612419, 0.5345224838, 0.8017837257}, Triple{-0.8703882798, 0.3481553119, -0.3481553119},
        Triple{0.4242640687, -0.8485281374, -0.3162277660}})
    found[i++] = glass_along(scene, place, unit(d));
  return found[0] == found[1] || found[0] == found[2] ? found[0] : found[1] == found[2] ? found[1] : 0;
}

int glass_around_light(const RoomScene &scene, int number) {
  const LightScene &light = scene.lights[static_cast<std::size_t>(number)];
  if (has_place(light)) return glass_around(scene, light.from);
  if (light.kind != LightScene::Kind::area) return 0;
  for (const Triangle &t : scene.surfaces.triangles)
    if (t.light == number) {
      const Triple area = t.area_vector_m2(), middle = (1.0 / 3) * (t.corner[0] + t.corner[1] + t.corner[2]);
      return glass_around(scene, middle + 1e-6 * std::sqrt(length(area)) * unit(area));
    }
  for (const Sphere &s : scene.surfaces.spheres)
    if (s.light == number) return glass_around(scene, s.centre + Triple{0, 0, s.radius_m * (1 + 1e-6)});
  return 0;
}

}  // namespace greenray
