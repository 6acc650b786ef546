#include "render/room_estimate.hpp"

#include <algorithm>
#include <chrono>

#include "render/photon_mapper.hpp"
#include "render/room_eye.hpp"
#include "render/room_plan.hpp"

namespace greenray {

RoomEstimate estimate_room(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device) {
  using Clock = std::chrono::steady_clock;
  const RoomPlan plan = plan_room(scene, options);
  RoomOptions probe = options;
  probe.checkpoint.clear(), probe.photon_map = 0, probe.crop.reset();
  probe.error_pct.reset(), probe.minutes.reset();
  for (int &side : probe.size) side = std::clamp(side / 4, 8, 400);
  probe.photons = std::clamp<std::int64_t>(plan.photons / 32, 4096, 100000);
  probe.spp = plan.samples;
  const auto begin = Clock::now();
  const RoomReport r = render_room(scene, probe, device).report;
  RoomEstimate out;
  out.compile_seconds = r.compile_seconds;
  out.probe_seconds = std::chrono::duration<double>(Clock::now() - begin).count() - r.compile_seconds;

  const auto pixels = [](const std::array<int, 2> &size) { return 1.0 * size[0] * size[1]; };
  const double more_photons = static_cast<double>(plan.photons_a_pass) / static_cast<double>(r.photons.photons),
               more_paths = static_cast<double>(plan.pixels()) * plan.samples / (pixels(probe.size) * r.spp);
  out.seconds_a_pass = (r.emit_seconds + r.map_seconds) * more_photons +
                       (r.gather_seconds + r.cover_seconds + r.eye_seconds) * more_paths;
  if (!plan.open) out.seconds = r.build_seconds + plan.passes * out.seconds_a_pass;
  else if (options.minutes && !options.error_pct) out.seconds = 60 * *options.minutes;

  const int waves = scene.spectrum.samples;
  const double records = static_cast<double>(r.photons.stored[0] + r.photons.stored[1]) * more_photons;
  out.device_bytes = PhotonMapper::device_bytes(static_cast<std::size_t>(1.25 * records), 0, waves) +
                     RoomEye(scene.camera, 0, plan, 0, false, static_cast<std::size_t>(waves)).device_bytes();
  return out;
}

}  // namespace greenray
