#include "render/room_plan.hpp"

#include <algorithm>
#include <cmath>

#include "support/error.hpp"

namespace greenray {
namespace {

constexpr int ordinary_passes = 4, fewest_nearest = 8;
constexpr std::int64_t enough_for_passes = 40000;
constexpr int most_passes = 1 << 24;  // of a run without another end

std::int64_t divided_up(std::int64_t a, std::int64_t b) { return (a + b - 1) / b; }

/// Everything that follows from the number of photons a pass.
void set_passes(RoomPlan &plan, const RoomScene &scene, const RoomOptions &options) {
  const std::int64_t whole = divided_up(plan.photons, plan.photons_a_pass);
  plan.open = options.error_pct || options.minutes;
  plan.passes =
      plan.open && !options.photons ? most_passes : static_cast<int>(std::min<std::int64_t>(whole, most_passes));
  const int ordinary = static_cast<int>(std::min<std::int64_t>(whole, ordinary_passes));
  plan.nearest = std::max(std::min(fewest_nearest, scene.photons.gather),
                          static_cast<int>(divided_up(scene.photons.gather, ordinary)));
  const int spp = options.spp.value_or(4);
  if (!plan.open) {
    plan.samples = static_cast<int>(divided_up(spp, plan.passes));
    return;
  }
  plan.samples = 1;
  if (options.spp) plan.passes = std::min(plan.passes, spp);
}

}  // namespace

std::uint32_t RoomPlan::photons_of(int pass) const {
  if (open) return static_cast<std::uint32_t>(photons_a_pass);
  const auto part = [&](std::int64_t p) {  // p photons/passes, without overflow
    return photons / passes * p + photons % passes * p / passes;
  };
  return static_cast<std::uint32_t>(part(pass + 1) - part(pass));
}

RoomPlan plan_room(const RoomScene &scene, const RoomOptions &options) {
  RoomPlan plan;
  plan.size = options.size;
  plan.crop = options.crop.value_or(std::array<int, 4>{0, 0, plan.size[0], plan.size[1]});
  const auto &c = plan.crop;
  if (c[0] < 0 || c[1] < 0 || c[2] > plan.size[0] || c[3] > plan.size[1] || c[0] >= c[2] || c[1] >= c[3])
    throw InputError(options.crop_place, "expected X0,Y0,X1,Y1 within the picture of " + std::to_string(plan.size[0]) +
                                             "x" + std::to_string(plan.size[1]) + " pixels, from below to");
  for (std::size_t a = 0; a < 2; ++a) {
    plan.region[a] = c[a] - RoomPlan::margin;
    plan.region[a + 2] = c[a + 2] + RoomPlan::margin;
  }
  plan.photons = options.photons.value_or(scene.photons.emitted);
  const int passes = options.passes > 0 ? options.passes : plan.photons < enough_for_passes ? 1 : ordinary_passes;
  plan.photons_a_pass = std::min(divided_up(plan.photons, passes), most_photons_a_pass);
  set_passes(plan, scene, options);
  return plan;
}

void halve_passes(RoomPlan &plan, const RoomScene &scene, const RoomOptions &options) {
  plan.photons_a_pass = divided_up(plan.photons_a_pass, 2);
  set_passes(plan, scene, options);
}

}  // namespace greenray
