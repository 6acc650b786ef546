#include "render/room.hpp"

#include "atmosphere/profile.hpp"
#include "render/room_photons.hpp"
#include "render/room_run.hpp"
#include "scene/bvh.hpp"

namespace greenray {

AirTable room_air(const RoomScene &scene, const std::vector<double> &wavelength_nm, bool straight) {
  AirTable air = uniform_air(0, wavelength_nm);
  if (scene.air && !straight) {
    const Profile profile(*scene.air);
    const surface32::GeometryBounds bounds = build_surface_tree(scene.surfaces, 1).bounds;
    AirTableOptions options;
    options.low_m = static_cast<double>(bounds.low[2]), options.high_m = static_cast<double>(bounds.high[2]);
    options.length_m = diagonal_m(bounds);
    options.error_m = 1e-3;
    air = build_air_table(layered_medium(profile, true), wavelength_nm, options);
  }
  air.extinction_per_m = scene.extinction_per_m;
  return air;
}

RoomPicture render_room(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device,
                        Ranks &ranks) {
  return RoomRun(scene, options, device, ranks).render();
}

RoomPicture render_room(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device) {
  OneRank alone;
  return render_room(scene, options, device, alone);
}

RoomPicture render_room(const RoomScene &scene, const RoomOptions &options,
                        const std::vector<std::shared_ptr<Device>> &devices) {
  if (devices.size() == 1) return render_room(scene, options, devices.front());
  RoomPicture picture;
  run_threads(static_cast<int>(devices.size()), [&](Ranks &ranks) {
    RoomPicture made = render_room(scene, options, devices[static_cast<std::size_t>(ranks.rank())], ranks);
    if (ranks.first()) picture = std::move(made);
  });
  return picture;
}

}  // namespace greenray
