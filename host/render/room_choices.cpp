#include "render/room_choices.hpp"

#include <algorithm>
#include <cmath>

#include "render/room_looks.hpp"
#include "render/room_photons.hpp"
#include "scene/bvh.hpp"

namespace greenray {
namespace {

bool is_glass(MaterialScene::Kind kind) {
  return kind == MaterialScene::Kind::dielectric || kind == MaterialScene::Kind::rough_dielectric;
}

PlanChoice paths_choice(const RoomScene &scene, const RoomOptions &options, const AirTable &air) {
  if (!scene.air) return {"paths", "straight segments", "the scene has no medium", 0, "mm"};
  if (options.straight) return {"paths", "straight segments", "--straight: what bending does is left out", 0, ""};
  if (air.is_straight()) return {"paths", "straight segments", "n is the same at all heights of the scene", 0, "mm"};
  return {"paths", "chains of parabolas through " + std::to_string(air.cells) + " cells of n^2",
          "n varies with height; costs: largest error of a place across the scene", 1000 * air.error_m, "mm"};
}

PlanChoice wavelengths_choice(const RoomScene &scene, const AirTable &air, double reach) {
  const double parted_mm = 1000 * air.parting_per_m() * reach * reach;
  if (medium_disperses(air, reach))
    return {"wavelengths", "each photon its own", "the medium parts them by more than a two-hundredth of the scene", 0,
            "mm"};
  const bool prism = std::any_of(scene.materials.begin(), scene.materials.end(),
                                 [](const MaterialScene &m) { return is_glass(m.kind) && m.index.disperses(); });
  return {"wavelengths", prism ? "together until glass parts them" : "together, along one path",
          "the medium parts them by less than a two-hundredth of the scene; costs: by how much", parted_mm, "mm"};
}

PlanChoice caustics_choice(const RoomScene &scene) {
  const bool shiny = std::any_of(scene.materials.begin(), scene.materials.end(),
                                 [](const MaterialScene &m) { return m.kind != MaterialScene::Kind::lambert; });
  if (!shiny) return {"caustic map", "none", "nothing mirrors or refracts", 0, ""};
  return {"caustic map", scene.photons.aimed ? "aimed by projection maps where that pays" : "not aimed",
          "mirrors, glass or rough surfaces throw light together", 0, ""};
}

}  // namespace

bool medium_disperses(const AirTable &air, double reach_m) { return air.parting_per_m() * reach_m > 5e-3; }

std::vector<PlanChoice> room_choices(const RoomScene &scene, const RoomOptions &options) {
  const AirTable air = room_air(scene, room_looks(scene).wavelength_nm, options.straight);
  const double reach = diagonal_m(build_surface_tree(scene.surfaces, 1).bounds);
  return {paths_choice(scene, options, air),
          wavelengths_choice(scene, air, reach),
          caustics_choice(scene),
          {"precision", "float", "places are good to 2^-22 of the scene", std::ldexp(1000 * reach, -22), "mm"},
          {"geometry",
           std::to_string(scene.surfaces.triangles.size()) + " triangles, " +
               std::to_string(scene.surfaces.spheres.size()) + " spheres in a tree",
           "surfaces are in the scene", 0, ""}};
}

}  // namespace greenray
