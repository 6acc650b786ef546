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
  const auto seconds_since = [](Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  };
  RoomEstimate out;
  auto begin = Clock::now();
  (void)render_room(scene, probe, device);  // PoCL compiles at first launches
  out.compile_seconds = seconds_since(begin);
  begin = Clock::now();
  const RoomReport r = render_room(scene, probe, device).report;
  out.probe_seconds = seconds_since(begin);
  out.compile_seconds = std::max(out.compile_seconds - out.probe_seconds, 0.0);

  // Pixels at the edges of light and of lamps have more paths; there are as many of them as a side is longer.
  const auto paths = [&](double width, double height, double longer) {
    return width * height * plan.samples + longer * static_cast<double>(8 * r.edge_pixels + 64 * r.lamp_pixels);
  };
  const double more_photons = static_cast<double>(plan.photons_a_pass) / static_cast<double>(r.photons.photons),
               longer = static_cast<double>(plan.width()) / probe.size[0],
               more_paths =
                   paths(plan.width(), plan.height(), longer) / (r.passes * paths(probe.size[0], probe.size[1], 1));
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
