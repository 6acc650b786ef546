#include "render/sun_place.hpp"

#include <cmath>

#include "atmosphere/diagnosis.hpp"
#include "compute/ray_tracer.hpp"
#include "render/host_rays.hpp"
#include "support/angle.hpp"

namespace greenray {

static constexpr double altitude_nm = 550;  // at which altitudes of Sun and horizon are given

static void make_dry(ProfileSpec &spec) {
  for (Level &level : spec.levels) level.relative_humidity.reset();
  for (Station &station : spec.stations) {
    auto air = std::make_shared<ProfileSpec>(*station.air);
    make_dry(*air);
    station.air = std::move(air);
  }
}

ProfileSpec spec_for(const Scene &scene, const RenderOptions &options) {
  ProfileSpec spec = scene.atmosphere.profile;
  if (options.straight) spec.exaggerate = 0;
  if (!scene.atmosphere.humidity) make_dry(spec);
  return spec;
}

double azimuth_from_path_rad(const Scene &scene) {
  const std::optional<double> path_deg = scene.atmosphere.profile.azimuth_deg;
  return path_deg ? to_rad(scene.observer.azimuth_deg - *path_deg) : 0;
}

HostRay reference_ray(const Scene &scene, const AirSection &air) {
  const bool flat = scene.atmosphere.surface == Surface::flat;
  const double height_m = scene.observer.height_m;
  if (!varies_along_surface(air.spec()))
    return host_ray(build_index_table(air.at(0), {altitude_nm}, {flat, 1e-5, height_m}), 0, height_m);
  SectionTable table =
      build_section_table(section_medium(air, flat), {altitude_nm}, {scene.tracing.table_arcsec, height_m});
  return host_ray(std::move(table), 0, {0, height_m}, azimuth_from_path_rad(scene));
}

double true_from_apparent_rad(double apparent_rad, const std::string &key, const SourcePlace &place,
                              const HostRay &reference) {
  const f64::RayEnd end = reference(apparent_rad);
  if (end.outcome == f64::RAY_SPACE) return apparent_rad - end.bending_rad;
  const double horizon_deg = to_deg(horizon_rad(reference).value_or(0));
  throw InputError(
      place, key + " = " + plain_number(to_deg(apparent_rad)) + ": light from there comes from the " +
                 outcome_name(end.outcome) +
                 ", not from the sky; expected an altitude from which light comes from the sky (the horizon is at " +
                 plain_number(horizon_deg) + " deg at 550 nm)");
}

/// True altitude of the point of the Sun that the scene names.
static double true_altitude_rad(const Scene &scene, const HostRay &reference) {
  if (scene.sun.given != SunScene::Given::apparent_altitude) return to_rad(scene.sun.altitude_deg);
  return true_from_apparent_rad(to_rad(scene.sun.altitude_deg), "sun.apparent_altitude_deg", scene.sun.altitude_place,
                                reference);
}

SunPlace place_of_sun(const Scene &scene, const HostRay &reference) {
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
  const bool sun = scene.sun.given == SunScene::Given::apparent_altitude;
  const bool moon = scene.moon.given == MoonScene::Given::apparent_altitude;
  if (!sun && !moon) return;
  const HostRay reference = reference_ray(scene, AirSection(spec_for(scene, options)));
  if (sun) (void)true_altitude_rad(scene, reference);
  if (moon)
    (void)true_from_apparent_rad(to_rad(scene.moon.altitude_deg), "moon.apparent_altitude_deg",
                                 scene.moon.altitude_place, reference);
}

}  // namespace greenray
