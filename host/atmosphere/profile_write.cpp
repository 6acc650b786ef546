// write_profile: a ProfileSpec as TOML text.
#include "atmosphere/air_section.hpp"
#include "atmosphere/profile_file.hpp"
#include "support/toml_reader.hpp"

namespace greenray {
namespace {

std::string word_of(IndexModel model) {
  for (const auto &[word, value] : index_model_words())
    if (value == model) return word;
  return "born-wolf";
}

std::string text_of(const AlongSurface &quantity) {
  if (!quantity.has_points()) return exact_decimal(quantity.constant());
  const auto array = [](const std::vector<double> &numbers) {
    std::string all;
    for (const double number : numbers) all += (all.empty() ? "" : ", ") + exact_decimal(number);
    return "[" + all + "]";
  };
  return "{ x_m = " + array(quantity.x_m) + ", value = " + array(quantity.value) + " }";
}

std::string quoted(const std::string &text) {
  std::string all = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') all += '\\';
    all += c;
  }
  return all + "\"";
}

/// `text` as a comment line. TOML comments hold no control characters and no broken UTF-8, which station names of old
/// files may bring along: those become spaces and question marks.
std::string comment(std::string text) {
  for (char &c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) c = ' ';
    if (byte >= 0x80) c = '?';
  }
  return "# " + text + "\n";
}

}  // namespace

std::string write_profile(const ProfileSpec &spec) {
  std::string text = comment(spec.name + ": an air profile for greenray");
  for (const std::string &note : spec.notes) text += comment(note);
  const auto line = [&text](const char *key, double value) {
    text += std::string(key) + " = " + exact_decimal(value) + "\n";
  };
  text += std::string("base = \"") + (spec.base_is_us76 ? "us76" : "none") + "\"\n";
  text += "index = \"" + word_of(spec.index) + "\"\n";
  line("earth_radius_m", spec.earth_radius_m);
  if (spec.stations.empty()) line("surface_pressure_Pa", spec.surface_pressure_Pa);
  text +=
      std::string("interpolation = \"") + (spec.interpolation == Interpolation::cubic ? "cubic" : "linear") + "\"\n";
  if (spec.stations.empty()) line("smooth_m", spec.smooth_m);
  line("exaggerate", spec.exaggerate);
  if (has_places(spec))
    text +=
        std::string("along_surface = \"") + (spec.along_surface == Interpolation::cubic ? "cubic" : "linear") + "\"\n";
  if (spec.azimuth_deg) line("azimuth_deg", *spec.azimuth_deg);
  for (const Station &station : spec.stations) {
    text += "\n[[station]]\n";
    line("x_m", station.x_m);
    text += "profile = " + quoted(station.file) + "\n";
  }
  for (const Level &level : spec.levels) {
    text += "\n[[level]]\n";
    line("height_m", level.height_m);
    line("temperature_K", level.temperature_K);
    if (level.pressure_Pa) line("pressure_Pa", *level.pressure_Pa);
    if (level.relative_humidity) line("relative_humidity", *level.relative_humidity);
  }
  for (const InversionSpec &inversion : spec.inversions)
    text += "\n[[inversion]]\ndelta_T_K = " + text_of(inversion.delta_T_K) +
            "\nheight_m = " + text_of(inversion.height_m) + "\ndiffuseness_m = " + text_of(inversion.diffuseness_m) +
            "\n";
  for (const SurfaceLayerSpec &layer : spec.surface_layers) {
    text += "\n[[surface_layer]]\n";
    line("delta_T_K", layer.delta_T_K);
    line("scale_m", layer.scale_m);
  }
  for (const IndexLevel &level : spec.index_levels) {
    text += "\n[[index_level]]\n";
    line("height_m", level.height_m);
    line("refractivity", level.refractivity);
  }
  return text;
}

}  // namespace greenray
