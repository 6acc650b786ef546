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

/// A picture of the scene's own number of photons has `gather` of them in an estimate. Of more photons, passes take
/// what makes noise and bias fall alike, as photons^(-1/3): noise^2 goes as 1/passes, bias as the area of a pass's
/// estimates.
int passes_for(std::int64_t photons, std::int64_t of_scene) {
  if (photons < enough_for_passes) return 1;
  const double more = std::max(1.0, static_cast<double>(photons) / static_cast<double>(of_scene));
  return static_cast<int>(std::min<double>(std::round(ordinary_passes * std::cbrt(more * more)), most_passes));
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
  const int passes = options.passes > 0                     ? options.passes
                     : options.error_pct || options.minutes ? passes_for(plan.photons, plan.photons)
                                                            : passes_for(plan.photons, scene.photons.emitted);
  plan.photons_a_pass = std::min(divided_up(plan.photons, passes), most_photons_a_pass);
  plan.even_radii =
      options.passes == 0 && passes > ordinary_passes && divided_up(plan.photons, passes) <= most_photons_a_pass;
  set_passes(plan, scene, options);
  return plan;
}

void halve_passes(RoomPlan &plan, const RoomScene &scene, const RoomOptions &options) {
  plan.photons_a_pass = divided_up(plan.photons_a_pass, 2);
  plan.even_radii = false;
  set_passes(plan, scene, options);
}

}  // namespace greenray
