#include "report/room_page.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "image/contact_sheet.hpp"
#include "report/page.hpp"

namespace greenray {
namespace {

using Json = nlohmann::json;
constexpr int picture_px = 480;

void facts_of(Page &page, const std::string &title, const Json &object) {
  if (!object.is_object()) return;
  page.section(title);
  std::vector<std::pair<std::string, std::string>> rows;
  for (const auto &[name, value] : object.items()) {
    if (value.is_structured()) continue;
    rows.emplace_back(name, value.is_null()           ? "-"
                            : value.is_number_float() ? cell(value.get<double>())
                            : value.is_string()       ? value.get<std::string>()
                                                      : value.dump());
  }
  page.facts(rows);
}

}  // namespace

std::string room_page(const Json &numbers, const Raster &developed, const std::optional<Raster> &photon_map) {
  const auto words = [&](const char *key) { return numbers.at(key).get<std::string>(); };
  Page page(words("title").empty() ? words("scene") : words("title"),
            "greenray " + words("version") + ", scene " + words("scene") + " (" + words("scene_hash") + ")");
  if (const double times = numbers.at("exaggerate").get<double>(); times != 1)
    page.warning("The refractivity of the medium is exaggerated " + cell(times, 6) + " times.");
  if (numbers.at("straight").get<bool>()) page.warning("Paths are straight: --straight.");
  page.section("The picture");
  page.picture(shrunk(developed, picture_px), words("scene"), std::min(picture_px, developed.width));
  if (photon_map)
    page.picture(shrunk(*photon_map, picture_px), "the photon map", std::min(picture_px, photon_map->width));
  facts_of(page, "Noise and bias, relative to the mean", numbers.at("error"));
  facts_of(page, "Energy of the photons of a pass [W/nm]", numbers.at("energy_W_nm"));
  facts_of(page, "Where photons ended", numbers.at("outcomes"));
  facts_of(page, "Photons", numbers.at("photons"));
  facts_of(page, "Passes", numbers.at("passes"));
  facts_of(page, "The Sun", numbers.at("sun"));
  facts_of(page, "Medium", numbers.at("medium"));
  facts_of(page, "Seconds", numbers.at("seconds"));
  facts_of(page, "Device", numbers.at("device"));
  facts_of(page, "Plan", numbers.at("plan"));
  for (const auto &[key, title] : {std::pair{"modelled", "What is modelled"}, {"left_out", "What is left out"}}) {
    page.section(title);
    for (const Json &line : numbers.at("plan").at(key)) page.text(line.get<std::string>());
  }
  page.section("The command that repeats it");
  page.code(words("command"));
  return page.finish();
}

}  // namespace greenray
