#include "render/room_picture.hpp"

#include <algorithm>

#include "render/room_maker.hpp"

namespace greenray {

PixelStatistics::Totals totals_of(const RoomPlan &plan, const PixelStatistics &pixels) {
  return pixels.totals(counting_pixels(plan), static_cast<std::size_t>(plan.width()));
}

RoomPicture picture_of(const RoomPlan &plan, const std::vector<double> &wavelength_nm, const RoomTally &tally,
                       const RoomReport &report) {
  const std::size_t waves = wavelength_nm.size(), pixels = plan.pixels();
  RoomPicture out{{}, report, {}};
  SpectralImage &image = out.image;
  image.width = plan.crop[2] - plan.crop[0], image.height = plan.crop[3] - plan.crop[1];
  image.wavelength_nm = wavelength_nm;
  image.radiance = cropped(plan, tally.pixels.mean(), waves, 1);
  const float of_band = 1 / static_cast<float>(waves);
  image.channels["noise"] = cropped(plan, tally.pixels.noise(), 1, of_band);
  image.channels["bias"] = cropped(plan, tally.pixels.bias(), 1, of_band);
  const float of_pass = 1 / static_cast<float>(std::max(tally.passes(), 1));
  auto from = tally.sums.begin();
  for (const char *name : {"depth_m", "bend_mrad", "photon_count"}) {
    const auto to = from + static_cast<std::ptrdiff_t>(pixels);
    image.channels[name] = cropped(plan, {from, to}, 1, of_pass);
    from = to;
  }
  const PixelStatistics::Totals totals = totals_of(plan, tally.pixels);
  RoomReport &r = out.report;
  r.noise_rms = totals.noise_rms, r.bias_rms = totals.bias_rms, r.bias_mean = totals.bias;
  r.bias_below = totals.bias_below, r.bias_is_seen = totals.bias_is_seen();
  r.error_rms = totals.error_rms(), r.error_of_rms = totals.error_of_rms();
  r.passes = tally.passes(), r.spp = r.passes * plan.samples, r.photons_a_pass = plan.photons_a_pass;
  r.photons = tally.photons, r.emit_seconds = tally.photons.seconds;
  return out;
}

}  // namespace greenray
