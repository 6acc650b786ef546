#include "render/room_maker.hpp"

#include <algorithm>
#include <chrono>

#include "render/photon_picture.hpp"
#include "render/room_choices.hpp"
#include "render/room_error.hpp"
#include "render/room_looks.hpp"
#include "scene/room_frame.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

}  // namespace

RoomMaker::RoomMaker(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device,
                     const RoomPlan &plan)
    : scene_(moved_to_middle(scene)), options_(options), device_(device), plan_(plan), looks_(room_looks(scene_)) {
  const auto begin = Clock::now();
  compiled_before_ = device->compile_seconds();
  air_ = room_air(scene_, looks_.wavelength_nm, options.straight);
  tree_ = build_surface_tree(scene_.surfaces, SurfaceScene::lanes_for(*device));
  tracer_.emplace(device, tree_, air_, looks_);
  known_.table_arcsec = room_table_error_arcsec(air_, diagonal_m(tree_.bounds));
  known_.solver_arcsec = room_solver_error_arcsec(*tracer_, air_, scene_.camera);
  alone_ = medium_disperses(air_, diagonal_m(tree_.bounds));
  known_.triangles = scene.surfaces.triangles.size(), known_.spheres = scene.surfaces.spheres.size();
  known_.air_cells = air_.cells, known_.table_error_m = air_.error_m;
  photons_.emplace(scene_, options_, device_, *tracer_, looks_, tree_.bounds, alone_);
  known_.build_seconds = seconds_since(begin) - (device->compile_seconds() - compiled_before_);
}

void RoomMaker::make_eye() {
  eye_.emplace(scene_.camera, glass_around(scene_, scene_.camera.from), plan_, options_.seed, alone_, looks_.waves());
}

void RoomMaker::begin() {
  make_eye();
  photons_->fit(plan_, eye_->device_bytes());
  make_eye();  // of the plan that fits
}

void RoomMaker::begin(const RoomBeginning &from, int lamp_passes) {
  const std::size_t pixels = plan_.pixels();
  const auto fit = [&](const std::vector<int> &list) {
    return std::all_of(list.begin(), list.end(), [&](int i) { return i >= 0 && static_cast<std::size_t>(i) < pixels; });
  };
  const auto has_room = [](int slots) { return slots >= 0 && slots < (1 << 24); };
  if (!fit(from.lamp_pixels) || !fit(from.edge_pixels) || !has_room(from.slots[0]) || !has_room(from.slots[1]))
    throw RunError("the checkpoint is of another picture");
  fit_passes(plan_, from.photons_a_pass, scene_, options_, {options_.checkpoint.string(), 1, 1});
  make_eye();
  photons_->fit_as(plan_, from.slots);
  photons_->mapper().set_radii(from.radii);
  eye_->set_lamp_pixels(from.lamp_pixels, lamp_passes), eye_->set_edge_pixels(from.edge_pixels);
}

RoomBeginning RoomMaker::beginning() {
  return {plan_.photons_a_pass, photons_->slots(), photons_->mapper().radii(), eye_->lamp_pixels(),
          eye_->edge_pixels()};
}

MadePass RoomMaker::make(int pass, const std::function<void(const char *, double)> &between) {
  MadePass made;
  stop_if_asked();
  between("photons", 0);
  photons_->trace(plan_, pass);
  stop_if_asked();
  between("picture", 0.5);
  if (pass == 0) eye_->find_radii(*tracer_, photons_->mapper());
  made.pass = eye_->see(pass, *tracer_, photons_->mapper());
  if (options_.photon_map > 0 && !photon_map_) picture_photons(made.pass);
  made.photons = photons_->totals();
  made.lamp_pixels = eye_->lamp_pixels();
  return made;
}

/// Both maps share out the dots as they share the photons.
void RoomMaker::picture_photons(const RoomPass &seen) {
  PhotonMap &diffuse = photons_->mapper().diffuse(), *caustic = photons_->mapper().caustic();
  const double all = static_cast<double>(diffuse.filed() + (caustic ? caustic->filed() : 0));
  PhotonPicture picture(seen.ends, static_cast<std::size_t>(plan_.width()), static_cast<std::size_t>(plan_.samples),
                        looks_.waves());
  for (const PhotonMap *map : {&diffuse, caustic}) {
    if (!map || map->filed() == 0) continue;
    const double share = static_cast<double>(map->filed()) / all;
    picture.show(map->read(), static_cast<std::size_t>(share * static_cast<double>(options_.photon_map)));
  }
  SpectralImage &image = photon_map_.emplace();
  image.width = plan_.crop[2] - plan_.crop[0], image.height = plan_.crop[3] - plan_.crop[1];
  image.wavelength_nm = looks_.wavelength_nm;
  image.radiance = cropped(plan_, picture.power(), looks_.waves(), 1);
  image.channels["photon_count"] = cropped(plan_, picture.counts(), 1, 1);
}

void RoomMaker::describe(RoomReport &r) const {
  r.triangles = known_.triangles, r.spheres = known_.spheres, r.air_cells = known_.air_cells;
  r.table_error_m = known_.table_error_m, r.table_arcsec = known_.table_arcsec;
  r.solver_arcsec = known_.solver_arcsec, r.build_seconds = known_.build_seconds;
  r.aimed_cells = photons_->aimed_cells();
  r.map_seconds = photons_->map_seconds(), r.cover_seconds = photons_->cover_seconds();
  r.gather_seconds = eye_->gather_seconds(), r.eye_seconds = tracer_->eye_seconds();
  r.compile_seconds = device_->compile_seconds() - compiled_before_;
}

void fit_passes(RoomPlan &plan, std::int64_t photons_a_pass, const RoomScene &scene, const RoomOptions &options,
                const SourcePlace &place) {
  while (plan.photons_a_pass > photons_a_pass && plan.photons_a_pass > 1) halve_passes(plan, scene, options);
  if (plan.photons_a_pass != photons_a_pass)
    throw InputError(place, "expected passes of " + std::to_string(plan.photons_a_pass) + " photons, found " +
                                std::to_string(photons_a_pass) + "; --no-resume starts anew");
}

std::vector<unsigned char> counting_pixels(const RoomPlan &plan) {
  std::vector<unsigned char> counts;
  for (int y = plan.region[1]; y < plan.region[3]; ++y)
    for (int x = plan.region[0]; x < plan.region[2]; ++x)
      counts.push_back(x >= plan.crop[0] && x < plan.crop[2] && y >= plan.crop[1] && y < plan.crop[3]);
  return counts;
}

std::vector<float> cropped(const RoomPlan &plan, const std::vector<float> &values, std::size_t each, float scale) {
  const std::vector<unsigned char> counts = counting_pixels(plan);
  std::vector<float> out;
  for (std::size_t p = 0; p < plan.pixels(); ++p)
    if (counts[p])
      for (std::size_t k = 0; k < each; ++k) out.push_back(values[p * each + k] * scale);
  return out;
}

}  // namespace greenray
