// greenray sunset: what the Sun of a scene does, in numbers: bands, folds, pieces, flattening, green rim and flash.
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/commands.hpp"
#include "render/sunset.hpp"
#include "scene/scene_file.hpp"
#include "support/angle.hpp"
#include "support/version.hpp"

namespace greenray::cli {
namespace {

using Json = nlohmann::json;

Json or_null(const std::optional<double> &value) { return value ? Json(*value) : Json(); }

Json spans_json(const std::vector<ApparentSpan> &spans) {
  Json list = Json::array();
  for (const ApparentSpan &s : spans) list.push_back({{"low_deg", s.low_deg}, {"high_deg", s.high_deg}});
  return list;
}

Json sun_json(const SunsetFigures &f) {
  if (!f.sun) return {};
  Json images = Json::array();
  for (const Image &i : f.images_of_centre)
    images.push_back({{"apparent_altitude_deg", i.apparent_altitude_deg},
                      {"orientation", i.erect ? "erect" : "inverted"},
                      {"magnification", i.magnification}});
  const bool seen = f.horizontal_arcsec > 0;
  return {{"true_altitude_deg", to_deg(f.sun->centre_rad)},
          {"diameter_arcsec", 2 * to_arcsec(f.sun->radius_rad)},
          {"pieces", spans_json(f.pieces)},
          {"images_of_centre", images},
          {"vertical_arcsec", f.vertical_arcsec},
          {"horizontal_arcsec", f.horizontal_arcsec},
          {"flattening", seen ? Json(f.vertical_arcsec / f.horizontal_arcsec) : Json()},
          {"green_rim_arcsec", or_null(f.green_rim_arcsec)}};
}

Json as_json(const Scene &scene, const SunsetFigures &f) {
  Json folds = Json::array();
  for (const Fold &fold : f.folds)
    folds.push_back({{"apparent_altitude_deg", fold.apparent_deg},
                     {"true_altitude_deg", fold.true_deg},
                     {"true_altitude_is", fold.lowest ? "lowest" : "highest"}});
  Json out{{"version", version()},
           {"scene", scene.name},
           {"title", scene.title},
           {"profile", scene.atmosphere.profile.name},
           {"height_m", scene.observer.height_m},
           {"sky", spans_json(f.sky)},
           {"folds", folds},
           {"sun", sun_json(f)},
           {"lowest_true_altitude_deg",
            {{"500", or_null(f.last_500_deg)},
             {"550", or_null(f.last_550_deg)},
             {"560", or_null(f.last_560_deg)},
             {"650", or_null(f.last_650_deg)}}},
           {"curve_arcsec", f.curve_arcsec},
           {"flash", Json()}};
  if (f.flash)
    out["flash"] = {{"green_s", f.flash->seconds},
                    {"first_true_altitude_deg", f.flash->first_deg},
                    {"last_true_altitude_deg", f.flash->last_deg},
                    {"brightest_lux", f.flash->brightest_lux}};
  return out;
}

void print_spans(std::ostream &out, const char *label, const std::vector<ApparentSpan> &spans) {
  out << label;
  for (std::size_t i = 0; i < spans.size(); ++i)
    out << (i > 0 ? ", " : "") << spans[i].low_deg << " to " << spans[i].high_deg;
  out << (spans.empty() ? "nowhere\n" : " deg\n");
}

void print_sun(std::ostream &out, const SunsetFigures &f) {
  out << "Sun      centre at " << to_deg(f.sun->centre_rad) << " deg true, " << f.pieces.size() << " piece(s)";
  print_spans(out, ": ", f.pieces);
  if (f.horizontal_arcsec > 0)
    out << "         " << f.vertical_arcsec << "\" high, " << f.horizontal_arcsec
        << "\" wide: " << f.vertical_arcsec / f.horizontal_arcsec << "\n";
  if (f.green_rim_arcsec) out << "rim      upper limb at 520 nm " << *f.green_rim_arcsec << "\" above that at 650 nm\n";
  if (f.flash && f.flash->seconds > 0)
    out << "flash    green for " << f.flash->seconds << " s at 15\" a second, centre from " << f.flash->first_deg
        << " to " << f.flash->last_deg << " deg true, at most " << f.flash->brightest_lux << " lux\n";
}

std::string as_text(const Scene &scene, const SunsetFigures &f) {
  std::ostringstream out;
  out.precision(6);
  out << "scene    " << scene.name << "  \"" << scene.title << "\"\nair      " << scene.atmosphere.profile.name
      << ", eye at " << scene.observer.height_m << " m; altitudes as seen, at 550 nm, unless they are called true\n";
  print_spans(out, "sky      ", f.sky);
  for (const Fold &fold : f.folds)
    out << "fold     " << fold.apparent_deg << " deg, true altitude " << fold.true_deg << ", "
        << (fold.lowest ? "lowest" : "highest") << " there\n";
  if (f.sun) print_sun(out, f);
  if (f.last_560_deg && f.last_500_deg && f.last_650_deg)
    out << "last     true altitudes down to " << *f.last_650_deg << " (650 nm), " << *f.last_560_deg << " (560), "
        << *f.last_500_deg << " (500) are seen\n";
  return out.str();
}

int run(const Arguments &a) {
  const Scene scene = load_scene(a.positional()[0], a.all("--set"), a.positional_place(0));
  const SunsetFigures figures = sunset_figures(scene, open_device(device_options(a)));
  emit(a, a.has("--json") ? as_json(scene, figures).dump(1) + "\n" : as_text(scene, figures));
  return 0;
}

}  // namespace

Command sunset_command() {
  return {with_common({"sunset",
                       "SCENE",
                       "What a scene's Sun does, in numbers: folds, pieces, flattening, green rim and flash.",
                       {{"--set", "-D", "KEY=VALUE", "override any scene key, repeatable", false, true},
                        {"--output", "-o", "FILE", "write to a file"}}}),
          run};
}

}  // namespace greenray::cli
