#include "report/sky_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "image/colour.hpp"
#include "image/contact_sheet.hpp"
#include "image/develop.hpp"
#include "render/host_rays.hpp"
#include "render/refraction.hpp"
#include "render/solver_choice.hpp"
#include "render/sun_place.hpp"
#include "report/page.hpp"
#include "report/view_json.hpp"
#include "report/view_plots.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

using Json = nlohmann::json;
constexpr int picture_px = 480, straight_px = 320;

std::string text_of(const Json &value) {
  if (value.is_null()) return "-";
  if (value.is_number_float()) return cell(value.get<double>());
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// The scene without bending, small, its Sun where it is without air. returns: nothing for a picture that is straight
std::optional<Raster> straight_picture(const SkyReportInput &in, const std::shared_ptr<Device> &device) {
  if (in.options.straight) return std::nullopt;
  Scene scene = in.scene;
  if (const auto &sun = in.rendered.report.sun_true_altitude_deg) {
    scene.sun.given = SunScene::Given::true_altitude, scene.sun.part = SunScene::Part::centre;
    scene.sun.altitude_deg = *sun;
  }
  scene.tracing.error_pct.reset(), scene.tracing.minutes.reset();
  scene.tracing.transfer = TracingScene::Transfer::table;
  RenderOptions options;
  options.seed = in.options.seed, options.straight = true, options.spp = 4;
  const double scale = std::min(1.0, static_cast<double>(straight_px) / (in.plan.crop[2] - in.plan.crop[0]));
  const auto scaled = [&](int pixels) { return std::max(1, static_cast<int>(std::lround(pixels * scale))); };
  options.size = {scaled(in.plan.size[0]), scaled(in.plan.size[1])};
  if (in.options.crop) {
    std::array<int, 4> crop{};
    for (std::size_t i = 0; i < 4; ++i) crop[i] = static_cast<int>(std::lround(in.plan.crop[i] * scale));
    for (std::size_t i = 0; i < 2; ++i) {
      crop[i] = std::min(crop[i], (*options.size)[i] - 1);
      crop[i + 2] = std::clamp(crop[i + 2], crop[i] + 1, (*options.size)[i]);
    }
    options.crop = crop;
  }
  const Rendered straight = render(scene, plan_render(scene, options), options, device);
  const RgbImage light = rgb_from_spectral(straight.image);
  const CameraOptions camera{scene.eye.exposure_ev, 8, true};
  if (in.key_cd_m2 <= 0) return develop_camera(light, camera).pixels;
  CameraReport report;
  report.key_cd_m2 = in.key_cd_m2;
  RgbImage display{light.width, light.height, std::vector<float>(light.rgb.size())};
  camera_rows(camera, report, light.rgb.data(), light.pixels(), display.rgb.data());
  return quantise(display, 8, true);
}

/// A tenth of the picture around the pixel whose green exceeds red and blue most, if there is one.
std::optional<Raster> brightest_green(const SkyReportInput &in, Json &numbers) {
  const RgbImage light = rgb_from_spectral(in.rendered.image);
  double most = 0;
  std::size_t at = 0;
  for (std::size_t i = 0; i < light.pixels(); ++i) {
    const auto [r, g, b] = light.pixel(i);
    if (g - std::max(r, b) > most) most = g - std::max(r, b), at = i;
  }
  if (!(most > 0)) return std::nullopt;
  const int column = static_cast<int>(at) % light.width, row = static_cast<int>(at) / light.width;
  numbers = {{"column", column}, {"row", row}, {"green_above_red_and_blue_cd_m2", most}};
  const Raster &from = in.developed;
  Raster part{std::max(1, std::min(from.width, picture_px / 10)),
              std::max(1, std::min(from.height, picture_px * 3 / 40)),
              from.bits,
              {}};
  const int left = std::clamp(column - part.width / 2, 0, from.width - part.width);
  const int top = std::clamp(row - part.height / 2, 0, from.height - part.height);
  for (int y = 0; y < part.height; ++y) {
    const auto begin = from.rgb.begin() + 3 * (static_cast<std::ptrdiff_t>(top + y) * from.width + left);
    part.rgb.insert(part.rgb.end(), begin, begin + 3 * part.width);
  }
  return part;
}

ViewDiagnosis view_of(const SkyReportInput &in, const AirSection &air, const std::shared_ptr<Device> &device) {
  ViewRequest request;
  request.height_m = in.scene.observer.height_m;
  request.flat = in.scene.atmosphere.surface == Surface::flat;
  request.section = in.plan.section;
  request.method = in.plan.section ? RayMethod::dormand_prince : RayMethod::cells;
  request.azimuth_rad = in.plan.azimuth_from_path_rad;
  return diagnose_view(air, request, device);
}

/// Refraction at three wavelengths, of layered air.
void refraction_table(const SkyReportInput &in, const AirSection &air, const std::shared_ptr<Device> &device,
                      Page &page, Json &numbers) {
  RefractionRequest request;
  request.height_m = in.scene.observer.height_m;
  request.flat = in.scene.atmosphere.surface == Surface::flat;
  const std::vector<double> &nm = in.plan.wavelengths_nm;
  request.wavelengths_nm = {nm.front(), nm[nm.size() / 2], nm.back()};
  request.wavelengths_nm.erase(std::unique(request.wavelengths_nm.begin(), request.wavelengths_nm.end()),
                               request.wavelengths_nm.end());
  request.altitudes_deg = {-0.2, -0.1, -0.05, 0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1, 2, 5, 10, 30, 45, 90};
  request.precision = device->info().has_double ? Precision::double_ : Precision::single_;
  request.tolerance_arcsec = 0.01;
  const RefractionTable table = greenray::refraction_table(air, request, device);
  std::vector<std::vector<std::string>> rows{{"seen altitude [deg]"}};
  for (const double w : request.wavelengths_nm) rows[0].push_back("refraction at " + cell(w) + " nm [″]");
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const RefractionRow &r = table.rows[i];
    if (i % request.wavelengths_nm.size() == 0) rows.push_back({cell(r.apparent_altitude_deg)});
    char text[32] = "";
    if (r.outcome == f64::RAY_SPACE) std::snprintf(text, sizeof text, "%.1f", *r.refraction_arcsec);
    rows.back().push_back(r.outcome == f64::RAY_SPACE ? text : outcome_name(r.outcome));
    numbers.push_back({{"apparent_altitude_deg", r.apparent_altitude_deg},
                       {"wavelength_nm", r.wavelength_nm},
                       {"status", outcome_name(r.outcome)},
                       {"refraction_arcsec", r.outcome == f64::RAY_SPACE ? Json(*r.refraction_arcsec) : Json()},
                       {"error_arcsec", r.error_arcsec}});
  }
  page.table(rows);
}

/* Refraction at 45 degrees by Oriani's theorem, which asks for n and the weight of the air at the eye only:
   (n-1)(1-b) tan z - (n-1)(b - (n-1)/2) tan^3 z, b = height of a homogeneous atmosphere over the distance to the
   centre. returns: NaN where it does not hold: flat, laboratory media */
double oriani_45_arcsec(const Profile &air, double height_m, bool flat) {
  if (flat || !air.is_air() || height_m > 20000) return std::nan("");
  const double n1 = air.refractivity(height_m, diagnosis_wavelength_nm).value;
  const double homogeneous_m = air.zenith_column_kg_m2(height_m) / air.density_kg_m3(height_m);
  const double b = homogeneous_m / (air.spec().earth_radius_m + height_m);
  return to_arcsec(n1 * (1 - b) - n1 * (b - n1 / 2));
}

Json trust_of(const SkyReportInput &in, const AirSection &air) {
  const bool flat = in.scene.atmosphere.surface == Surface::flat;
  const double height_m = in.scene.observer.height_m;
  const Profile over_eye = air.at(0);
  Json trust{{"oriani_45_arcsec", nullptr}, {"ours_45_arcsec", nullptr}, {"step_halving_arcsec", nullptr}};
  if (in.plan.section) return trust;
  const IndexTable table = build_index_table(over_eye, {diagnosis_wavelength_nm}, {flat, 1e-5, height_m});
  const double oriani = oriani_45_arcsec(over_eye, height_m, flat);
  const f64::RayEnd end = trace_on_host(table, 0, height_m, pi / 4);
  if (std::isfinite(oriani) && end.outcome == f64::RAY_SPACE)
    trust["oriani_45_arcsec"] = oriani, trust["ours_45_arcsec"] = to_arcsec(end.bending_rad);
  // Order 5: a 32nd of the tolerance halves the steps.
  double worst = 0;
  for (int i = 0; i < 24; ++i) {
    const double e = to_rad(in.plan.first_elevation_deg) +
                     from_arcsec(in.plan.spacing_arcsec) * static_cast<double>(in.plan.entries) * (i + 0.5) / 24;
    if (e > pi / 2) break;
    const f64::RayEnd whole = trace_on_host(table, 0, height_m, e, {}, 1e-9),
                      half = trace_on_host(table, 0, height_m, e, {}, 1e-9 / 32);
    if (whole.outcome == f64::RAY_SPACE && half.outcome == f64::RAY_SPACE)
      worst = std::max(worst, to_arcsec(std::abs(whole.bending_rad - half.bending_rad)));
  }
  trust["step_halving_arcsec"] = worst;
  return trust;
}

/// Relative noise of every pixel: black 0.1 % and less, white all of it, in decades.
std::optional<Raster> noise_map(const SpectralImage &image) {
  const auto variance = image.channels.find("variance");
  if (variance == image.channels.end()) return std::nullopt;
  RgbImage map{image.width, image.height, std::vector<float>(3 * image.pixels())};
  const std::size_t waves = image.wavelength_nm.size();
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    double mean = 0;
    for (std::size_t w = 0; w < waves; ++w)
      mean += static_cast<double>(image.radiance[i * waves + w]) / static_cast<double>(waves);
    const double noise = mean > 0 ? std::sqrt(static_cast<double>(variance->second[i])) / mean : 0;
    const double level = srgb_decode(std::clamp(std::log10(std::max(noise, 1e-3)) / 3 + 1, 0.0, 1.0));
    map.set_pixel(i, {level, level, level});
  }
  return shrunk(quantise(map, 8, false), straight_px);
}

void facts_of(Page &page, const Json &object) {
  std::vector<std::pair<std::string, std::string>> rows;
  for (const auto &[name, value] : object.items())
    if (!value.is_structured()) rows.emplace_back(name, text_of(value));
  page.facts(rows);
}

void lines_of(Page &page, const std::string &what, const Json &list) {
  for (const Json &line : list) page.text(what + line.get<std::string>());
}

void pictures(const SkyReportInput &in, Page &page, Json &numbers, const std::shared_ptr<Device> &device) {
  page.section("1  The picture");
  const int width = std::min(picture_px, in.developed.width);
  page.picture(shrunk(in.developed, picture_px), in.scene.title.empty() ? in.scene.name : in.scene.title, width);
  if (const auto straight = straight_picture(in, device))
    page.picture(*straight, "the same scene with straight rays, the Sun where it is without air", width);
  Json place;
  if (const auto green = brightest_green(in, place))
    page.picture(*green, "the brightest green, 10 times enlarged", 10 * green->width, true);
  else page.text("No pixel is greener than it is red and blue.");
  numbers["brightest_green"] = place;
}

void colours(const SkyReportInput &in, Page &page, Json &numbers) {
  page.section("4  Colour along the Sun's upper rim");
  const EyeScene &eye = in.scene.eye;
  const double seconds =
      eye.bleaching_steady ? std::numeric_limits<double>::infinity() : eye.bleaching_seconds.value_or(10);
  const auto rim = rim_colour(in.rendered.image, in.plan.pixel_arcsec, seconds);
  numbers["rim"] = rim ? rim_json(*rim) : Json();
  if (!rim) return page.text("No disk of the Sun stands out in this picture.");
  page.text("Column " + std::to_string(rim->column) + " of the picture, " + cell(in.plan.pixel_arcsec, 3) +
            "″ a pixel, from above the rim downwards. Bleached: cones that looked at the disk itself for " +
            (std::isfinite(seconds) ? cell(seconds) + " s" : "good") + ", of which L " + cell(rim->unbleached[0], 3) +
            ", M " + cell(rim->unbleached[1], 3) + ", S " + cell(rim->unbleached[2], 3) + " are left (of 1).");
  page.figure(rim_figures(*rim));
}

void trust(const SkyReportInput &in, Page &page, const Json &numbers) {
  page.section("5  Trust");
  page.text("Rays launched " + text_of(numbers["rays_launched"]) + "; where they ended (the counts sum to the rays):");
  facts_of(page, numbers["outcomes"]);
  page.text(
      "Errors: of the table against one 30 times finer, of the solver, of looking the table up half way (arc-seconds); "
      "noise and bias relative to the mean radiance.");
  facts_of(page, numbers["error"]);
  page.text(
      "Refraction at 45 degrees by Oriani's theorem, from the air at the eye alone, and by our rays; largest change of "
      "bending where steps of order 5 are halved.");
  facts_of(page, numbers["trust"]);
  if (const auto map = noise_map(in.rendered.image))
    page.picture(*map, "relative noise of each pixel: black 0.1 %, each third of the way to white ten times more",
                 map->width);
}

void speed(Page &page, const Json &numbers) {
  page.section("6  Speed");
  facts_of(page, numbers["seconds"]);
  facts_of(page, numbers["speed"]);
  facts_of(page, numbers["device"]);
  page.text("The command that repeats it:");
  page.code(numbers["command"].get<std::string>());
}

}  // namespace

std::string sky_report(const SkyReportInput &in, Json &numbers, const std::shared_ptr<Device> &device) {
  Page page(in.scene.title.empty() ? in.scene.name : in.scene.title,
            "greenray " + numbers["version"].get<std::string>() + ", scene " + in.scene.name + " (" +
                numbers["scene_hash"].get<std::string>() + ")");
  if (in.scene.atmosphere.profile.exaggerate != 1)
    page.warning("The refractivity of this air is exaggerated " + cell(in.scene.atmosphere.profile.exaggerate, 6) +
                 " times.");
  if (in.options.straight) page.warning("Rays are straight: --straight.");
  const AirSection air(spec_for(in.scene, in.options));
  pictures(in, page, numbers, device);
  const ViewDiagnosis view = view_of(in, air, device);
  numbers["view"] = view_json(view);
  page.section("2  The air");
  for (const std::string &sentence : view.air.expect) page.text(sentence);
  page.figure({air_figure(view)});
  page.section("3  Rays and the transfer curve");
  page.figure({fan_figure(view), transfer_figure(view), count_figure(view)});
  numbers["refraction"] = Json::array();
  if (!in.plan.section) refraction_table(in, air, device, page, numbers["refraction"]);
  colours(in, page, numbers);
  numbers["trust"] = trust_of(in, air);
  numbers["command"] = in.command;
  const TraceStats &stats = in.rendered.report.trace;
  numbers["speed"] = {
      {"rays_per_second",
       stats.device_seconds > 0 ? Json(static_cast<double>(stats.rays) / stats.device_seconds) : Json()},
      {"steps_per_ray",
       stats.rays > 0 ? Json(static_cast<double>(stats.steps) / static_cast<double>(stats.rays)) : Json()}};
  trust(in, page, numbers);
  speed(page, numbers);
  page.section("What is modelled");
  lines_of(page, "", numbers["plan"]["modelled"]);
  page.section("What is left out");
  lines_of(page, "", numbers["plan"]["left_out"]);
  return page.finish();
}

}  // namespace greenray
