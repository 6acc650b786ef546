// What a scene needs, and no more.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "render/host_rays.hpp"
#include "render/polar_terrain.hpp"
#include "render/renderer.hpp"
#include "render/solver_choice.hpp"
#include "render/spectrum.hpp"
#include "render/sun_place.hpp"
#include "render/targets.hpp"
#include "support/angle.hpp"
#include "twin/twin.hpp"

namespace greenray {
namespace {

constexpr double finest_spacing_arcsec = 1;  // of the transfer table, also for coarse pixels
constexpr std::size_t most_entries = 32768;

std::array<int, 2> picture_size(const Scene &scene, const RenderOptions &options) {
  std::array<int, 2> size = options.size.value_or(scene.observer.resolution);
  if (options.quick)
    for (int &n : size) n = std::max(1, n / 4);
  return size;
}

struct ElevationRange {
  double low = 1e9, high = -1e9;
  void include(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

/// Elevations that the whole picture sees (a crop uses the same table, so that it has the same bits): the extremes lie
/// on the border, or at zenith and nadir inside it.
ElevationRange elevation_range(const Scene &scene, const RenderPlan &plan) {
  const double tangent = 2 * std::tan(to_rad(scene.observer.fov_deg) / 2) / plan.size[0];
  const double altitude = to_rad(scene.observer.altitude_deg);
  ElevationRange range;
  const auto look = [&](double column, double row) {
    const double right = (column - 0.5 * plan.size[0]) * tangent, up = (0.5 * plan.size[1] - row) * tangent;
    const double forward = std::cos(altitude) - up * std::sin(altitude);
    const double height = std::sin(altitude) + up * std::cos(altitude);
    range.include(std::atan2(height, std::hypot(forward, right)));
  };
  constexpr int points = 64;
  for (int i = 0; i <= points; ++i) {
    const double column = plan.size[0] * static_cast<double>(i) / points;
    const double row = plan.size[1] * static_cast<double>(i) / points;
    look(column, 0);
    look(column, plan.size[1]);
    look(0, row);
    look(plan.size[0], row);
    look(0.5 * plan.size[0], row);  // straight ahead: steepest in its row
  }
  const double half_height = 0.5 * plan.size[1] * tangent;
  if (std::abs(altitude) + std::atan(half_height) >= pi / 2) range.include(altitude > 0 ? pi / 2 : -pi / 2);
  const double margin = 2 * to_rad(scene.observer.fov_deg) / plan.size[0];
  return {std::max(range.low - margin, -pi / 2), std::min(range.high + margin, pi / 2)};
}

void size_transfer_table(const Scene &scene, RenderPlan &plan) {
  const ElevationRange range = elevation_range(scene, plan);
  const double wanted = from_arcsec(std::min(plan.pixel_arcsec / 2, finest_spacing_arcsec));
  const double entries = std::clamp(std::ceil((range.high - range.low) / wanted), 2.0, double(most_entries));
  plan.entries = static_cast<std::size_t>(entries) + 1;
  plan.first_elevation_deg = to_deg(range.low);
  plan.spacing_arcsec = to_arcsec((range.high - range.low) / entries);
}

double pixel_share(double arcsec, const RenderPlan &plan) { return arcsec / plan.pixel_arcsec; }

constexpr double float_arcsec = 0.005;  // what float leaves uncertain at the horizon; measured, docs/method.md

void choose_solver(const Scene &scene, const RenderOptions &options, RenderPlan &plan) {
  using Method = TracingScene::Method;
  const TracingScene &t = scene.tracing;
  const ProfileSpec air = spec_for(scene, options);
  const SolverChoice choice = choose_solver(air,
                                            t.method == Method::richardson ? "richardson"
                                            : t.method == Method::rk45     ? "rk"
                                            : t.method == Method::cells    ? "cells"
                                                                           : "auto",
                                            air.place);
  plan.method = choice.method;
  plan.section = choice.section;
  plan.azimuth_from_path_rad = azimuth_from_path_rad(scene);
  const bool constant = options.straight || scene.atmosphere.profile.exaggerate == 0;
  const std::string why = has_places(air) && !constant    ? choice.why
                          : t.method != Method::automatic ? "tracing.method asks for it"
                          : constant                      ? "n is constant: the closed form of a straight line"
                                                          : "n depends on height alone: layers in closed form";
  plan.choices.push_back(
      {"solver", plan.section ? "adaptive" : method_name(plan.method), why, constant ? 0 : t.table_arcsec, "arcsec"});

  const bool fine_pixels = plan.pixel_arcsec < 20 * float_arcsec;
  const bool asked = t.precision != TracingScene::Precision::automatic;
  const bool in_double = asked ? t.precision == TracingScene::Precision::double_ : fine_pixels;
  plan.precision = in_double ? Precision::double_ : Precision::single_;
  std::ostringstream words;
  words << "float is good to " << float_arcsec << "\", " << pixel_share(float_arcsec, plan) << " pixel";
  plan.choices.push_back({"precision", in_double ? "double" : "float",
                          asked ? "tracing.precision asks for it" : words.str(), in_double ? 1e-5 : float_arcsec,
                          "arcsec"});

  plan.per_pixel = t.transfer == TracingScene::Transfer::per_pixel;
  plan.choices.push_back(
      {"rays", plan.per_pixel ? "every sample of every pixel" : "one transfer curve over elevation and wavelength",
       plan.per_pixel ? "tracing.transfer = \"per-pixel\""
                      : "what a ray does depends on its elevation and wavelength alone",
       plan.per_pixel ? 0 : t.table_arcsec, "arcsec"});
}

/// Of the outermost wavelengths, through a coarse table.
std::array<HostRay, 2> outermost_rays(const Scene &scene, const RenderOptions &options, const RenderPlan &plan) {
  const AirSection air(spec_for(scene, options));
  const double height_m = scene.observer.height_m, error_arcsec = 0.01;
  const bool flat = scene.atmosphere.surface == Surface::flat;
  const std::vector<double> ends{plan.wavelengths_nm.front(), plan.wavelengths_nm.back()};
  if (plan.section) {
    const SectionTable table = build_section_table(section_medium(air, flat), ends, {error_arcsec, height_m});
    return {host_ray(table, 0, {0, height_m}, plan.azimuth_from_path_rad),
            host_ray(table, 1, {0, height_m}, plan.azimuth_from_path_rad)};
  }
  const IndexTable table = build_index_table(air.at(0), ends, {flat, error_arcsec, height_m});
  return {host_ray(table, 0, height_m), host_ray(table, 1, height_m)};
}

/// Where the air varies, rays of one elevation differ with azimuth: by how much at the sides of the picture, against
/// its middle, over elevations across it [arcsec].
double azimuth_arcsec(const Scene &scene, const RenderOptions &options, const RenderPlan &plan) {
  const AirSection air(spec_for(scene, options));
  const double height_m = scene.observer.height_m, half = to_rad(scene.observer.fov_deg) / 2;
  const SectionTable table =
      build_section_table(section_medium(air, scene.atmosphere.surface == Surface::flat),
                          {plan.wavelengths_nm[plan.wavelengths_nm.size() / 2]}, {0.01, height_m});
  const HostSection section(table);
  const auto ray = [&](double elevation, double aside) {
    return section.trace(launch(table, 0, {0, height_m}, elevation, plan.azimuth_from_path_rad + aside), 1e-10);
  };
  const double low = to_rad(plan.first_elevation_deg);
  const double high = low + from_arcsec(plan.spacing_arcsec) * static_cast<double>(plan.entries - 1);
  constexpr int rows = 24;
  double widest = 0;
  for (int i = 0; i <= rows; ++i) {
    const double e = low + (high - low) * i / rows;
    const f64_section::RayEnd middle = ray(e, 0), beside = ray(e + from_arcsec(plan.pixel_arcsec), 0);
    if (middle.outcome != f64_section::RAY_SPACE || beside.outcome != middle.outcome) continue;
    // What a shift by a pixel does: near folds a small difference of direction is a large one of bending.
    const double stretch =
        std::max(1.0, std::abs(beside.bending_rad - middle.bending_rad) / from_arcsec(plan.pixel_arcsec));
    for (double side : {-half, half}) {
      const f64_section::RayEnd end = ray(e, side);
      if (end.outcome == middle.outcome)
        widest = std::max(widest, std::abs(end.bending_rad - middle.bending_rad) / stretch);
    }
  }
  return to_arcsec(widest);
}

/// How far apart the picture's outermost wavelengths are seen, at most, over elevations across the picture and just
/// above its horizon.
double dispersion_arcsec(const Scene &scene, const RenderOptions &options, const RenderPlan &plan) {
  const std::array<HostRay, 2> rays = outermost_rays(scene, options, plan);
  const double low = to_rad(plan.first_elevation_deg);
  const double high = low + from_arcsec(plan.spacing_arcsec) * static_cast<double>(plan.entries - 1);
  std::vector<double> elevations;
  for (int i = 0; i <= 8; ++i) elevations.push_back(low + (high - low) * i / 8);
  if (const auto horizon = horizon_rad(rays[0]))
    if (*horizon > low && *horizon < high) elevations.push_back(*horizon + from_arcsec(10));
  double widest = 0;
  for (double e : elevations) {
    const f64::RayEnd a = rays[0](e), b = rays[1](e);
    if (a.outcome == b.outcome) widest = std::max(widest, std::abs(a.bending_rad - b.bending_rad));
  }
  return to_arcsec(widest);
}

constexpr double visible_pixels = 0.1;  // images of two wavelengths nearer to each other than this look like one

/// One wavelength's rays serve all where the eye could not see them part.
void choose_wavelengths(const Scene &scene, const RenderOptions &options, RenderPlan &plan) {
  plan.bent_nm = plan.wavelengths_nm;
  const bool asked = scene.tracing.dispersion != TracingScene::Dispersion::automatic;
  if (plan.wavelengths_nm.size() == 1) {
    plan.choices.push_back({"bending", "one wavelength", "the picture has one", 0, ""});
    return;
  }
  const double apart = dispersion_arcsec(scene, options, plan), pixels = pixel_share(apart, plan);
  const bool one = asked ? scene.tracing.dispersion == TracingScene::Dispersion::off : pixels < visible_pixels;
  if (one) plan.bent_nm = {plan.wavelengths_nm[plan.wavelengths_nm.size() / 2]};
  std::ostringstream words;
  words << (asked ? "tracing.dispersion asks for it; " : "") << plan.wavelengths_nm.front() << " and "
        << plan.wavelengths_nm.back() << " nm are seen at most " << apart << "\" apart, " << pixels << " pixel";
  if (!asked) words << (one ? ", below " : ", above ") << visible_pixels;
  plan.choices.push_back(
      {"bending", one ? "one wavelength for all" : "each wavelength its own", words.str(), one ? pixels : 0, "pixel"});
}

void note_azimuths(const Scene &scene, const RenderOptions &options, RenderPlan &plan) {
  if (!plan.section || plan.per_pixel) return;
  const double apart = azimuth_arcsec(scene, options, plan), pixels = pixel_share(apart, plan);
  std::ostringstream words;
  words << "at the sides of the picture rays of the same elevation are bent " << apart << "\" otherwise, " << pixels
        << " pixel";
  const bool seen = pixels > visible_pixels;
  if (seen) words << ": more than " << visible_pixels << "; tracing.transfer = \"per-pixel\" follows it, slowly";
  plan.choices.push_back({"azimuth", "the air along the middle of the picture", words.str(), apart, "arcsec"});
  if (seen) plan.left_out.push_back("change of the air with azimuth: " + words.str());
}

void plan_sea(const Scene &scene, RenderPlan &plan) {
  if (!scene.sea.rough) return;
  const SeaState state = sea_state(scene.sea);
  std::ostringstream words;
  words << "waves of " << 4 * state.height_m << " m significant height, slopes of " << to_deg(state.slope) << " deg";
  if (state.height_m <= 0) return plan.left_out.push_back("waves: a wind of 0 m/s raises none");
  if (plan.per_pixel) return plan.left_out.push_back("waves: tracing.transfer = \"per-pixel\"");
  plan.rough_sea = true;
  plan.choices.push_back({"sea", "rough", words.str() + "; crests in a ray's way are counted along it", 0, ""});
  plan.modelled.push_back("waves before the horizon and before targets: " + words.str());
}

void plan_targets(const Scene &scene, RenderPlan &plan) {
  plan.station_m = station_distances_m(scene);
  if (plan.station_m.empty()) return;
  plan.choices.push_back(
      {"targets",
       std::to_string(scene.targets.size()) + " at " + std::to_string(plan.station_m.size()) +
           (plan.station_m.size() == 1 ? " distance" : " distances"),
       "a ray's height at a distance depends on its elevation and wavelength alone: a table for each",
       plan.per_pixel ? 0 : 0.5 * plan.spacing_arcsec, "arcsec"});
}

void plan_terrain(const Scene &scene, RenderPlan &plan) {
  const TerrainScene &terrain = scene.terrain;
  if (!terrain.field) return;
  require_tiles(scene, plan);
  plan.terrain = true;
  std::ostringstream words;
  words << "up to " << terrain.farthest_m / 1000 << " km from " << terrain.field->tiles().size()
        << (terrain.field->tiles().size() == 1 ? " file" : " files") << ", nodes " << terrain.field->spacing_m()
        << " m apart";
  plan.choices.push_back({"terrain", "heights over azimuth and distance", words.str(), 0.02, "pixel"});
  plan.modelled.push_back("terrain " + words.str() + ", each place where the bent ray meets it first");
  plan.left_out.push_back("shadows of terrain, and light that it throws on itself and on the air");
  if (plan.section) plan.left_out.push_back("terrain in the way of the air: profiles begin at the sea everywhere");
}

void explain(const Scene &scene, const RenderOptions &options, RenderPlan &plan) {
  auto &did = plan.modelled, &left = plan.left_out;
  if (options.straight) left.push_back("bending: --straight");
  else
    did.push_back(plan.section ? "bent rays: the index varies with height and along the surface"
                               : "bent rays: the index varies with height");
  if (plan.bent_nm.size() > 1) did.push_back("dispersion: " + std::to_string(plan.bent_nm.size()) + " wavelengths");
  else
    left.push_back(plan.wavelengths_nm.size() > 1
                       ? "dispersion of bending: too small to be seen, or tracing.dispersion = \"off\""
                       : "dispersion: one wavelength asked for");
  const bool academic = scene.sky.model == SkyScene::Model::academic;
  if (academic) left.push_back("sky light and extinction: academic sky (black, white disk)");
  else if (!scene.atmosphere.extinction) left.push_back("extinction: atmosphere.extinction = false");
  else
    did.push_back("extinction along the bent path: Rayleigh, ozone" +
                  std::string(scene.atmosphere.visibility_km || scene.atmosphere.turbidity ? ", aerosol" : ""));
  const bool by_sun = scene.sun.given != SunScene::Given::nothing;
  const bool by_moon = scene.moon.given != MoonScene::Given::nothing;
  if (by_moon)
    did.push_back(scene.moon.shadow_arcmin ? "the Moon, in the light that the Earth's air bends into its shadow"
                                           : "the Moon, by its phase");
  if (by_sun && by_moon) left.push_back("moonlight on air and sea: the Sun lights them");
  if (!academic && scene.atmosphere.extinction && (by_sun || by_moon)) {
    did.push_back("light of the sky: scattered once along the bent path, and again by air and ground" +
                  std::string(plan.section ? ", in the air over the eye" : ""));
    did.push_back(scene.sky.surface == SkyScene::Surface::land ? "the ground: Lambertian"
                  : scene.sky.sea_reflectance                  ? "the sea: a mirror of the sky at 10 degrees"
                                                               : "the sea: sky and Sun mirrored by waves");
    left.push_back("clouds, the light of the night sky, and polarisation");
  }
  if (scene.sun.given == SunScene::Given::nothing) left.push_back("the Sun: no [sun] in the scene");
  else did.push_back(std::string("the Sun") + (scene.sun.limb_darkening && !academic ? " with limb darkening" : ""));
  if (!plan.station_m.empty()) {
    did.push_back("targets: " + std::to_string(scene.targets.size()) +
                  ", each where the bent ray meets it, through the extinction and airlight of its path");
    left.push_back("light that targets throw on each other, on the air and on the sea, and their shadows");
  }
  left.push_back("geometry, photons and caustics: none in the scene");
  if (scene.eye.model == EyeScene::Model::human)
    did.push_back("the human eye: " + std::string(scene.eye.glare ? "glare, " : "") +
                  (scene.eye.acuity ? "acuity, " : "") + (scene.eye.colour ? "mesopic colour, " : "") + "tone curve" +
                  (scene.eye.bleaching_seconds || scene.eye.bleaching_steady ? ", bleaching" : ""));
}

}  // namespace

AzimuthRange azimuths_from(const Scene &scene, const RenderPlan &plan, double azimuth_rad) {
  const double tangent = std::tan(to_rad(scene.observer.fov_deg) / 2);
  const double altitude = to_rad(scene.observer.altitude_deg);
  const double half_height = tangent * plan.size[1] / plan.size[0];
  // The widest row is the one nearest to the zenith or the nadir; where that is in the picture, all azimuths are.
  const double forward = std::cos(altitude) - half_height * std::sin(std::abs(altitude));
  if (forward <= 1e-9) return {0, pi};
  const double half_width = std::atan2(tangent, forward) * 1.001, away = std::abs(std::remainder(azimuth_rad, 2 * pi));
  return {std::max(0.0, away - half_width), std::min(pi, away + half_width)};
}

RenderPlan plan_render(const Scene &scene, const RenderOptions &options) {
  RenderPlan plan;
  plan.size = picture_size(scene, options);
  plan.crop = options.crop.value_or(std::array<int, 4>{0, 0, plan.size[0], plan.size[1]});
  if (plan.crop[0] < 0 || plan.crop[1] < 0 || plan.crop[2] > plan.size[0] || plan.crop[3] > plan.size[1] ||
      plan.crop[0] >= plan.crop[2] || plan.crop[1] >= plan.crop[3])
    throw InputError(options.crop_place, "--crop: expected X0,Y0,X1,Y1 inside the picture of " +
                                             std::to_string(plan.size[0]) + "x" + std::to_string(plan.size[1]));
  plan.wavelengths_nm =
      wavelengths_even_in_refraction(scene.atmosphere.profile.index, scene.spectrum.range_nm, scene.spectrum.samples);
  const TracingScene &t = scene.tracing;
  plan.pixel_arcsec = to_arcsec(2 * std::tan(to_rad(scene.observer.fov_deg) / 2) / plan.size[0]);
  size_transfer_table(scene, plan);
  choose_solver(scene, options, plan);
  choose_wavelengths(scene, options, plan);
  note_azimuths(scene, options, plan);
  plan_targets(scene, plan);
  plan_sea(scene, plan);
  plan_terrain(scene, plan);

  const bool own = options.spp || options.error_pct || options.minutes;
  const std::optional<int> spp = own ? options.spp : t.spp;
  plan.error_pct = own ? options.error_pct : t.error_pct;
  plan.minutes = own ? options.minutes : t.minutes;
  plan.spp = spp.value_or(plan.error_pct || plan.minutes ? 1 << 20 : 16);

  const auto pixels =
      static_cast<std::size_t>(plan.crop[2] - plan.crop[0]) * static_cast<std::size_t>(plan.crop[3] - plan.crop[1]);
  const std::size_t padded = (plan.wavelengths_nm.size() + 7) / 8 * 8;
  plan.host_bytes = pixels * (plan.wavelengths_nm.size() + padded + 8) * sizeof(float) +
                    plan.entries * plan.wavelengths_nm.size() * 300;
  plan.device_bytes =
      pixels * (padded + 2) * sizeof(float) + plan.entries * padded * 12 * sizeof(float) + (std::size_t{1} << 18) * 168;
  if (const std::size_t stations = plan.station_m.size() + (plan.rough_sea ? 1 : 0); stations > 0) {
    plan.device_bytes += plan.entries * stations * padded * f32::TARGET_CHANNEL_COUNT * sizeof(float);
    plan.host_bytes +=
        plan.entries * stations * (padded * f32::TARGET_CHANNEL_COUNT * sizeof(float) + plan.bent_nm.size() * 200);
  }
  explain(scene, options, plan);
  return plan;
}

}  // namespace greenray
