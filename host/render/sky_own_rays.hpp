// For comparison with the transfer table: every sample of every pixel traces rays of its own.
#pragma once
#include "render/sky.hpp"
#include "render/sky_picture.hpp"
#include "render/sky_rays.hpp"
#include "render/targets.hpp"

namespace greenray {

/// Targets whose rays are traced sample by sample, too. places: null where there are none.
struct OwnRayTargets {
  const Scene &scene;
  const TargetShapes &shapes;
  SightPlaces *places;
};

/// Fills the picture row by row: rays on the device, then the kernel's own shading text on the host. view.rows and
/// view.first_row are set here. progress: called with the fraction done.
void shade_with_own_rays(SkyRays &rays, const SkyLight &light, const OwnRayTargets &targets, f32::SkyView view,
                         const RenderPlan &plan, SkyPicture &picture, const std::function<void(double)> &progress);

}  // namespace greenray
