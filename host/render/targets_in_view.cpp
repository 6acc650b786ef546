#include "render/targets_in_view.hpp"

#include <algorithm>
#include <cmath>

#include "support/angle.hpp"

namespace greenray {
namespace {

const char *kind_name(TargetScene::Kind kind) {
  switch (kind) {
    case TargetScene::Kind::rectangle:
      return "rectangle";
    case TargetScene::Kind::triangle:
      return "triangle";
    case TargetScene::Kind::polygon:
      return "polygon";
    case TargetScene::Kind::billboard:
      return "billboard";
  }
  return "";
}

double top_m(const TargetScene &target) {
  if (target.kind != TargetScene::Kind::polygon) return target.base_m + target.height_m;
  double highest = target.outline_m.front()[1];
  for (const auto &corner : target.outline_m) highest = std::max(highest, corner[1]);
  return target.base_m + highest;
}

/// Looks along azimuths of the picture, a place every 100 m.
SceneTarget highest_ground(const Scene &scene) {
  constexpr int columns = 721;
  constexpr double step_m = 100;
  const double half = to_rad(scene.observer.fov_deg) / 2, middle = to_rad(scene.observer.azimuth_deg);
  SceneTarget highest{{}, "highest terrain"};
  std::size_t hint = 0;
  for (int c = 0; c < columns; ++c) {
    const double aside = half * (2.0 * c / (columns - 1) - 1);
    const GeodesicLine line(scene.terrain.eye, middle + aside, scene.terrain.farthest_m);
    for (double distance_m = step_m; distance_m < scene.terrain.farthest_m; distance_m += step_m) {
      float height = 0;
      if (scene.terrain.field->height(line.at(distance_m), height, hint) != HeightField::Cover::land) continue;
      if (static_cast<double>(height) > highest.target.height_m)
        highest.target = {distance_m, static_cast<double>(height)};
    }
  }
  return highest;
}

}  // namespace

std::vector<SceneTarget> targets_in_view(const Scene &scene) {
  std::vector<SceneTarget> found;
  for (const TargetScene &target : scene.targets)
    found.push_back({{target.distance_m, top_m(target)},
                     "target " + std::to_string(found.size() + 1) + ", " + kind_name(target.kind)});
  if (!scene.terrain.field) return found;
  const SceneTarget ground = highest_ground(scene);
  if (ground.target.height_m > 0) found.push_back(ground);
  return found;
}

}  // namespace greenray
