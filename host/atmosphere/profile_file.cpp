#include "atmosphere/profile_file.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>

#include "atmosphere/air_section.hpp"
#include "support/embedded.hpp"
#include "support/toml_reader.hpp"

namespace greenray {
namespace {

constexpr double top_of_air_m = 120000.0;
constexpr std::size_t max_sounding_bytes = std::size_t{1} << 30;  // a station's whole IGRA2 history

constexpr Limits air_height{0, top_of_air_m, "m"};
constexpr Limits index_height{0, 1e7, "m"};
constexpr Limits temperature{100, 2000, "K"};
constexpr Limits temperature_change{-2000, 2000, "K"};
constexpr Limits pressure{0, 1e7, "Pa", true};
constexpr Limits thickness{thinnest_layer_m, 1e5, "m"};
constexpr Limits distance{-1e9, 1e9, "m"};

const std::vector<std::string> us76_names{"us76", "ussa1976", "us_standard_1976"};

bool is_us76(const std::string &name) {
  return std::find(us76_names.begin(), us76_names.end(), name) != us76_names.end();
}

/// Heights must rise from row to row; both neighbours are named so that either can be mended.
template <class Row>
void check_ascending(const std::vector<TomlTable> &tables, const std::vector<Row> &rows) {
  for (std::size_t i = 1; i < rows.size(); ++i)
    if (!(rows[i].height_m >= rows[i - 1].height_m + closest_levels_m))
      tables[i].complain("height_m", "expected heights to ascend from row to row by 0.0005 m or more, found " +
                                         exact_decimal(rows[i].height_m) + " m after " +
                                         exact_decimal(rows[i - 1].height_m) + " m");
}

std::vector<Level> read_levels(const TomlTable &root) {
  std::vector<Level> levels;
  std::vector<TomlTable> good;
  for (const TomlTable &row : root.rows("level")) {
    Level level;
    level.place = row.place();
    bool right = row.require("height_m", air_height.text()) && row.read("height_m", level.height_m, air_height);
    row.require("temperature_K", temperature.text());
    row.read("temperature_K", level.temperature_K, temperature);
    row.read("pressure_Pa", level.pressure_Pa, pressure);
    row.read("relative_humidity", level.relative_humidity, Limits{0, 1});
    if (!right) continue;  // complained about; leave it out of the order check
    levels.push_back(level);
    good.push_back(row);
  }
  check_ascending(good, levels);
  return levels;
}

std::vector<IndexLevel> read_index_levels(const TomlTable &root) {
  constexpr Limits refractivity{-0.9, 10};
  std::vector<IndexLevel> levels;
  std::vector<TomlTable> good;
  for (const TomlTable &row : root.rows("index_level")) {
    IndexLevel level;
    level.place = row.place();
    bool right = row.require("height_m", index_height.text()) && row.read("height_m", level.height_m, index_height);
    row.require("refractivity", refractivity.text());
    row.read("refractivity", level.refractivity, refractivity);
    if (!right) continue;
    levels.push_back(level);
    good.push_back(row);
  }
  check_ascending(good, levels);
  return levels;
}

/// A number, or { x_m = [..], value = [..] }.
AlongSurface read_along_surface(const TomlTable &row, const std::string &key, const Limits &limits) {
  AlongSurface result(0.0);
  if (!row.require(key, limits.text() + ", or { x_m = [..], value = [..] }")) return result;
  if (!row.holds_table(key)) {
    double constant = 0;
    if (row.read(key, constant, limits)) result = constant;
    return result;
  }
  const TomlTable table = row.table(key);
  AlongSurface varying;
  const bool has_x = table.require("x_m", "an array of ascending distances in m");
  const bool has_value = table.require("value", "an array, each " + limits.text());
  const bool right_x = has_x && table.read("x_m", varying.x_m, distance);
  const bool right_value = has_value && table.read("value", varying.value, limits);
  if (!right_x || !right_value) return result;
  if (varying.x_m.size() < 2) return table.complain("x_m", "expected at least 2 distances"), result;
  if (varying.x_m.size() != varying.value.size())
    return table.complain("value", "expected as many numbers as x_m has, " + std::to_string(varying.x_m.size()) +
                                       ", found " + std::to_string(varying.value.size())),
           result;
  if (std::adjacent_find(varying.x_m.begin(), varying.x_m.end(), std::greater_equal<>()) != varying.x_m.end())
    return table.complain("x_m", "expected distances that ascend"), result;
  return varying;
}

/// from_m, to_m, rise_K: the ramp a sounding shows. The Fermi step of G04 4.4 with the same centre, the same rise and
/// the same gradient at the centre, which is rise/(4 diffuseness), stands for it: diffuseness = (to - from)/4.
void read_ramp(const TomlTable &row, InversionSpec &inversion) {
  double from_m = 0, to_m = 0, rise_K = 0;
  const bool all = row.require("from_m", air_height.text()) & row.require("to_m", air_height.text()) &
                   row.require("rise_K", temperature_change.text());
  const bool right = row.read("from_m", from_m, air_height) & row.read("to_m", to_m, air_height) &
                     row.read("rise_K", rise_K, temperature_change);
  if (!all || !right) return;
  if (!(to_m >= from_m + 4 * thinnest_layer_m))
    return row.complain("to_m", "expected a height 0.004 m or more above from_m, " + exact_decimal(from_m) + " m");
  inversion.delta_T_K = rise_K;
  inversion.height_m = 0.5 * (from_m + to_m);
  inversion.diffuseness_m = 0.25 * (to_m - from_m);
}

std::vector<InversionSpec> read_inversions(const TomlTable &root) {
  std::vector<InversionSpec> inversions;
  for (const TomlTable &row : root.rows("inversion")) {
    InversionSpec inversion{0.0, 0.0, 1.0, row.place()};
    const bool fermi = row.has("delta_T_K") | row.has("height_m") | row.has("diffuseness_m");
    const bool ramp = row.has("from_m") | row.has("to_m") | row.has("rise_K");
    if (fermi && ramp) {
      row.complain(row.has("from_m") ? "from_m"
                   : row.has("to_m") ? "to_m"
                                     : "rise_K",
                   "expected either delta_T_K, height_m, diffuseness_m or from_m, to_m, rise_K, not some of each");
    } else if (ramp) {
      read_ramp(row, inversion);
    } else {
      inversion.delta_T_K = read_along_surface(row, "delta_T_K", temperature_change);
      inversion.height_m = read_along_surface(row, "height_m", air_height);
      inversion.diffuseness_m = read_along_surface(row, "diffuseness_m", thickness);
    }
    inversions.push_back(inversion);
  }
  return inversions;
}

std::vector<SurfaceLayerSpec> read_surface_layers(const TomlTable &root) {
  std::vector<SurfaceLayerSpec> layers;
  for (const TomlTable &row : root.rows("surface_layer")) {
    SurfaceLayerSpec layer;
    layer.place = row.place();
    row.require("delta_T_K", temperature_change.text());
    row.read("delta_T_K", layer.delta_T_K, temperature_change);
    row.require("scale_m", thickness.text());
    row.read("scale_m", layer.scale_m, thickness);
    layers.push_back(layer);
  }
  return layers;
}

/// As load_profile; in_station: of a [[station]], which has none of its own.
ProfileSpec load(const std::string &name_or_file, const std::string &folder, const SourcePlace &asked_at,
                 const SoundingChoice &choice, bool in_station);

/// The air of one [[station]]: a file beside this one, or a shipped profile; itself without stations and lists.
std::shared_ptr<const ProfileSpec> read_station_air(const TomlTable &row, const std::string &file,
                                                    const std::string &folder) {
  auto air = std::make_shared<ProfileSpec>(load(file, folder, row.place("profile"), {}, true));
  if (has_places(*air))
    throw InputError(row.place("profile"), "'profile': expected air that depends on height alone; '" + file +
                                               "' has stations or lists { x_m = [..], value = [..] } of its own");
  if (!air->index_levels.empty())
    throw InputError(row.place("profile"), "'profile': expected air; '" + file + "' gives refractivity directly");
  return air;
}

/// folder: where files are looked for first.
std::vector<Station> read_stations(TomlDocument &document, const TomlTable &root, const std::string &folder) {
  std::vector<Station> stations;
  for (const TomlTable &row : root.rows("station")) {
    Station station;
    station.place = row.place();
    const bool right = row.require("x_m", distance.text()) && row.read("x_m", station.x_m, distance);
    const bool named =
        row.require("profile", "the name of a profile or a sounding") && row.read("profile", station.file);
    if (!right || !named) continue;
    if (!stations.empty() && !(station.x_m > stations.back().x_m))
      row.complain("x_m", "expected distances to ascend from station to station, found " + exact_decimal(station.x_m) +
                              " m after " + exact_decimal(stations.back().x_m) + " m");
    try {
      station.air = read_station_air(row, station.file, folder);
      stations.push_back(std::move(station));
    } catch (const InputError &error) {
      document.complain(error);
    }
  }
  if (stations.size() == 1 && root.rows("station").size() == 1)
    root.complain("station", "expected two stations or more; a path with one is that station's profile itself");
  return stations;
}

void refuse_beside_stations(const TomlTable &root) {
  if (!root.has("station")) return;
  for (const char *other : {"level", "surface_layer", "index_level", "smooth_m", "surface_pressure_Pa"})
    if (root.has(other))
      root.complain(other, "not allowed beside [[station]]: expected it in the profiles of the stations");
}

void read_base(const TomlTable &root, ProfileSpec &spec) {
  TomlTable::Words<bool> words;
  for (const std::string &name : us76_names) words.emplace_back(name.c_str(), true);
  words.emplace_back("none", false);
  root.read_word("base", spec.base_is_us76, words);
  if (!spec.base_is_us76 && !root.has("level") && !root.has("index_level") && !root.has("station"))
    root.complain("base", "\"none\" expects [[level]] rows, [[index_level]] or [[station]] rows, in the same file");
}

void refuse_mixtures(const TomlTable &root, const ProfileSpec &spec) {
  if (spec.index_levels.empty()) return;
  for (const char *other : {"level", "inversion", "surface_layer"})
    if (root.has(other))
      root.complain(other, "not allowed beside [[index_level]]: refractivity given directly takes the place of air");
}

ProfileSpec read_toml(const std::string &file, std::string_view text, bool in_station) {
  TomlDocument document(file, text);
  const TomlTable root = document.root();
  ProfileSpec spec;
  root.read_word("index", spec.index, index_model_words());
  root.read("earth_radius_m", spec.earth_radius_m, {1e3, 1e9, "m"});
  root.read("surface_pressure_Pa", spec.surface_pressure_Pa, {0, 1e7, "Pa", true});
  root.read_word("interpolation", spec.interpolation,
                 {{"linear", Interpolation::linear}, {"cubic", Interpolation::cubic}});
  root.read_word("along_surface", spec.along_surface,
                 {{"linear", Interpolation::linear}, {"cubic", Interpolation::cubic}});
  root.read("azimuth_deg", spec.azimuth_deg, {-360, 360, "degrees"});
  root.read("smooth_m", spec.smooth_m, {0, 1e5, "m"});
  root.read("exaggerate", spec.exaggerate, {0, 1e6, "", true});
  spec.levels = read_levels(root);
  spec.inversions = read_inversions(root);
  spec.surface_layers = read_surface_layers(root);
  spec.index_levels = read_index_levels(root);
  if (in_station && root.has("station"))
    root.complain("station", "not allowed in the profile of a station: expected air that depends on height alone");
  else spec.stations = read_stations(document, root, std::filesystem::path(file).parent_path().string());
  read_base(root, spec);
  refuse_mixtures(root, spec);
  refuse_beside_stations(root);
  document.finish();
  return spec;
}

/// "us76" from "us76", "us76.toml", "profiles/us76.toml" or an alias.
std::string shipped_name(std::string name) {
  if (name.rfind("profiles/", 0) == 0) name.erase(0, 9);
  if (name.size() > 5 && name.compare(name.size() - 5, 5, ".toml") == 0) name.erase(name.size() - 5);
  return is_us76(name) ? us76_names.front() : name;
}

ProfileSpec parse(const std::string &file, std::string_view text, const SoundingChoice &choice, bool in_station) {
  const std::filesystem::path path(file);
  const std::string kind = path.extension().string();
  const bool table =
      kind == ".csv" || kind == ".txt" || kind == ".html" || kind == ".htm";  // never TOML, even when empty
  if (table || (kind != ".toml" && looks_like_sounding(file, text))) return read_sounding(file, text, choice);
  ProfileSpec spec = read_toml(file, text, in_station);
  spec.name = path.stem().string();
  spec.place = {file, 1, 1};
  return spec;
}

ProfileSpec load(const std::string &name_or_file, const std::string &relative_to_folder, const SourcePlace &asked_at,
                 const SoundingChoice &choice, bool in_station) {
  const std::filesystem::path asked(name_or_file);
  const std::size_t most = asked.extension() == ".toml" ? max_toml_bytes : max_sounding_bytes;
  for (const std::filesystem::path &path : {std::filesystem::path(relative_to_folder) / asked, asked})
    if (const auto text = file_contents(path.string(), most, asked_at))
      return parse(path.lexically_normal().string(), *text, choice, in_station);
  const std::string name = shipped_name(name_or_file);
  const std::string shipped = "profiles/" + name + ".toml";
  if (const auto text = embedded_file(shipped)) return parse(shipped, *text, choice, in_station);
  const std::vector<std::string> names = shipped_profiles();
  throw InputError(asked_at, "'" + name_or_file + "' is neither a file nor a shipped profile" +
                                 did_you_mean(name, names) + "; shipped: " + comma_list(names));
}

}  // namespace

const std::vector<std::pair<const char *, IndexModel>> &index_model_words() {
  static const std::vector<std::pair<const char *, IndexModel>> words{{"born-wolf", IndexModel::born_wolf},
                                                                      {"iag1999", IndexModel::iag1999},
                                                                      {"ciddor", IndexModel::ciddor},
                                                                      {"peck-reeder", IndexModel::peck_reeder}};
  return words;
}

ProfileSpec parse_profile(const std::string &file, std::string_view text, const SoundingChoice &choice) {
  return parse(file, text, choice, false);
}

std::vector<std::string> shipped_profiles() {
  std::vector<std::string> names;
  for (const std::string &path : embedded_files("profiles/"))
    if (path.size() > 5 && path.compare(path.size() - 5, 5, ".toml") == 0) names.push_back(shipped_name(path));
  std::sort(names.begin(), names.end());
  return names;
}

std::optional<std::string> file_contents(const std::string &path, std::size_t max_bytes, const SourcePlace &asked_at) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (!std::filesystem::exists(status) || std::filesystem::is_directory(status)) return std::nullopt;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(asked_at, "cannot read '" + path + "': is reading it allowed?");
  std::string text;
  std::string block(1 << 16, '\0');
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0) {
    text.append(block, 0, static_cast<std::size_t>(in.gcount()));
    if (text.size() > max_bytes)
      throw InputError(asked_at,
                       "'" + path + "' is too large: expected at most " + std::to_string(max_bytes >> 20) + " MiB");
  }
  if (in.bad()) throw InputError(asked_at, "cannot read '" + path + "' to its end");
  return text;
}

ProfileSpec load_profile(const std::string &name_or_file, const std::string &relative_to_folder,
                         const SourcePlace &asked_at, const SoundingChoice &choice) {
  return load(name_or_file, relative_to_folder, asked_at, choice, false);
}

}  // namespace greenray
