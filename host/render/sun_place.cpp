#include "render/sun_place.hpp"

#include <cmath>

#include "atmosphere/diagnosis.hpp"
#include "compute/ray_tracer.hpp"
#include "render/host_rays.hpp"
#include "support/angle.hpp"

namespace greenray {

static constexpr double altitude_nm = 550;  // at which altitudes of Sun and horizon are given

ProfileSpec spec_for(const Scene &scene, const RenderOptions &options) {
  ProfileSpec spec = scene.atmosphere.profile;
  if (options.straight) spec.exaggerate = 0;
  if (!scene.atmosphere.humidity)
    for (Level &level : spec.levels) level.relative_humidity.reset();
  return spec;
}

IndexTable reference_table(const Scene &scene, const Profile &profile) {
  return build_index_table(profile, {altitude_nm},
                           {scene.atmosphere.surface == Surface::flat, 1e-5, scene.observer.height_m});
}

/// True altitude of the point of the Sun that the scene names: given, or along the ray at 550 nm from its apparent
/// place.
static double true_altitude_rad(const Scene &scene, const IndexTable &reference) {
  const double given = to_rad(scene.sun.altitude_deg);
  if (scene.sun.given != SunScene::Given::apparent_altitude) return given;
  const f64::RayEnd end = trace_on_host(reference, 0, scene.observer.height_m, given);
  if (end.outcome == f64::RAY_SPACE) return given - end.bending_rad;
  const double horizon_deg = to_deg(horizon_rad(reference, scene.observer.height_m).value_or(0));
  throw InputError(
      scene.sun.altitude_place,
      "sun.apparent_altitude_deg = " + plain_number(scene.sun.altitude_deg) + ": light from there comes from the " +
          outcome_name(end.outcome) +
          ", not from the sky; expected an altitude from which light comes from the sky (the horizon is at " +
          plain_number(horizon_deg) + " deg at 550 nm)");
}

SunPlace place_of_sun(const Scene &scene, const IndexTable &reference) {
  const SunScene &sun = scene.sun;
  SunPlace place;
  place.radius_rad = to_rad(sun.diameter_arcmin / 60) / 2;
  if (sun.given == SunScene::Given::nothing) return place;
  place.shines = true;
  const double offset = sun.part == SunScene::Part::upper_limb   ? -place.radius_rad
                        : sun.part == SunScene::Part::lower_limb ? place.radius_rad
                                                                 : 0;
  place.true_altitude_rad = true_altitude_rad(scene, reference) + offset;
  double azimuth = sun.azimuth_deg.value_or(scene.observer.azimuth_deg) - scene.observer.azimuth_deg;
  azimuth -= 360 * std::round(azimuth / 360);
  place.azimuth_rad = to_rad(azimuth);
  return place;
}

void require_sun_in_sky(const Scene &scene, const RenderOptions &options) {
  if (scene.sun.given == SunScene::Given::apparent_altitude)
    (void)true_altitude_rad(scene, reference_table(scene, Profile(spec_for(scene, options))));
}

}  // namespace greenray
