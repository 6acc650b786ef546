// [[material]]: what surfaces are made of.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "atmosphere/profile_file.hpp"
#include "scene/room_materials.hpp"
#include "support/embedded.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_file_bytes = std::size_t{1} << 30;

void read_glass(const TomlTable &row, MaterialScene &material) {
  GlassIndex &glass = material.index;
  int given = 0;
  double constant = 0;
  if (row.has("index")) {
    ++given;
    if (row.read("index", constant, {1, 10})) glass = {GlassIndex::Kind::constant, {constant}, {}};
  }
  if (const TomlTable cauchy = row.table("cauchy"); cauchy.exists()) {
    ++given;
    std::vector<double> b(3, 0.0);
    cauchy.require("A", "a number: the index for long waves");
    cauchy.read("A", b[0], {1, 10});
    cauchy.read("B_um2", b[1], {0, 1, "um^2"});
    cauchy.read("C_um4", b[2], {0, 1, "um^4"});
    glass = {GlassIndex::Kind::cauchy, b, {}};
  }
  if (const TomlTable sellmeier = row.table("sellmeier"); sellmeier.exists()) {
    ++given;
    glass.kind = GlassIndex::Kind::sellmeier;
    sellmeier.require("B", "three numbers");
    sellmeier.require("C_um2", "three numbers in um^2");
    if (sellmeier.read("B", glass.b, {0, 100}) & sellmeier.read("C_um2", glass.c_um2, {0, 1000, "um^2"}) &&
        (glass.b.size() != glass.c_um2.size() || glass.b.empty()))
      sellmeier.complain("C_um2", "expected as many numbers as in B");
  }
  if (given > 1) row.complain("index", "expected one of index, cauchy and sellmeier");
  row.read("absorption_per_m", material.absorption_per_m, {0, 1e6, "1/m"});
}

void read_conductor(const TomlTable &row, MaterialScene &material) {
  const auto three = [&](const char *key, std::array<double, 3> &into) {
    std::vector<double> values;
    if (!row.read(key, values, {0, 100})) return;
    if (values.size() != 3) return row.complain(key, "expected three numbers, at 630, 532 and 465 nm");
    std::copy(values.begin(), values.end(), into.begin());
  };
  three("conductor_n", material.conductor_n);
  three("conductor_k", material.conductor_k);
}

}  // namespace

double GlassIndex::at(double wavelength_nm) const {
  const double l2 = 1e-6 * wavelength_nm * wavelength_nm;  // um^2
  if (kind == Kind::constant) return b[0];
  if (kind == Kind::cauchy) return b[0] + b[1] / l2 + b[2] / (l2 * l2);
  double n2 = 1;
  for (std::size_t i = 0; i < b.size(); ++i) n2 += b[i] * l2 / (l2 - c_um2[i]);
  return std::sqrt(std::max(n2, 1.0));
}

bool read_triple(const TomlTable &table, const std::string &key, Triple &into, const Limits &limits) {
  std::vector<double> values;
  if (!table.read(key, values, limits)) return false;
  if (values.size() != 3) return table.complain(key, "expected [x, y, z], three numbers"), false;
  std::copy(values.begin(), values.end(), into.begin());
  return true;
}

bool read_colour(const TomlTable &table, const std::string &key, Colour &into, const Limits &limits) {
  if (table.holds_array(key)) {
    std::vector<double> values;
    if (!table.read(key, values, limits)) return false;
    if (values.size() != 3) return table.complain(key, "expected a number, or [r, g, b]"), false;
    into.kind = Colour::Kind::rgb;
    std::copy(values.begin(), values.end(), into.rgb.begin());
    return true;
  }
  double grey = 0;
  if (!table.read(key, grey, limits)) return false;
  into = {Colour::Kind::grey, {grey, grey, grey}, 6500};
  return true;
}

std::optional<FoundText> find_beside(const std::string &folder, const std::string &name, const SourcePlace &asked_at) {
  const std::string path = (fs::path(folder) / name).lexically_normal().string();
  if (const auto text = file_contents(path, most_file_bytes, asked_at)) return FoundText{path, *text};
  if (const auto text = embedded_file(path)) return FoundText{path, std::string(*text)};
  return std::nullopt;
}

Materials::Materials(const TomlTable &root, const std::string &folder, RoomScene &scene)
    : folder_(folder), scene_(scene) {
  for (const TomlTable &row : root.rows("material")) {
    MaterialScene material;
    material.place = row.place();
    row.require("name", "a name in quotes");
    if (row.read("name", material.name) && find(material.name))
      row.complain("name", "expected a name of its own: '" + material.name + "' is taken");
    read(row, material);
    scene_.materials.push_back(material);
  }
}

void Materials::read(const TomlTable &row, MaterialScene &material) {
  using Kind = MaterialScene::Kind;
  row.read_word("kind", material.kind,
                {{"lambert", Kind::lambert},
                 {"mirror", Kind::mirror},
                 {"dielectric", Kind::dielectric},
                 {"rough-conductor", Kind::rough_conductor},
                 {"rough-dielectric", Kind::rough_dielectric}});
  const bool glass = material.kind == Kind::dielectric || material.kind == Kind::rough_dielectric;
  const bool rough = material.kind == Kind::rough_conductor || material.kind == Kind::rough_dielectric;
  if (!glass && material.kind != Kind::rough_conductor) {
    if (material.kind == Kind::lambert && !row.has("reflectance") && !row.has("texture"))
      row.require("reflectance", "a number from 0 to 1 or [r, g, b]");
  }
  if (!glass) read_colour(row, "reflectance", material.reflectance, {0, 1});
  std::string texture;
  if (material.kind == Kind::lambert && row.read("texture", texture)) {
    if (row.has("reflectance")) row.complain("texture", "expected either reflectance or texture, found both");
    material.texture =
        add_texture(texture, row.place("texture"), [&](const std::string &what) { row.complain("texture", what); });
  }
  if (glass) read_glass(row, material);
  if (rough) row.read("roughness", material.roughness, {0.001, 1});
  if (material.kind == Kind::rough_conductor) read_conductor(row, material);
}

std::optional<int> Materials::find(const std::string &name) const {
  for (std::size_t i = 0; i < scene_.materials.size(); ++i)
    if (!name.empty() && scene_.materials[i].name == name) return static_cast<int>(i);
  return std::nullopt;
}

std::optional<int> Materials::add_texture(const std::string &name, const SourcePlace &place,
                                          const std::function<void(const std::string &)> &complain) {
  const std::string path = (fs::path(folder_) / name).lexically_normal().string();
  const std::string extension = fs::path(name).extension().string();
  if (extension != ".png" && extension != ".exr") {
    complain("expected a picture that ends in .png or .exr, found \"" + name + "\"");
    return std::nullopt;
  }
  if (!fs::exists(path) && !embedded_file(path)) {
    complain("no such picture: '" + path + "'");
    return std::nullopt;
  }
  for (std::size_t i = 0; i < scene_.textures.size(); ++i)
    if (scene_.textures[i].path == path) return static_cast<int>(i);
  scene_.textures.push_back({path, place});
  return static_cast<int>(scene_.textures.size() - 1);
}

int Materials::of_row(const TomlTable &row) {
  const bool named = row.has("material"), plain = row.has("reflectance");
  if (named && plain) row.complain("reflectance", "expected either material or reflectance, found both");
  std::string name;
  if (named && row.read("material", name)) {
    if (const auto found = find(name)) return *found;
    std::vector<std::string> names;
    for (const MaterialScene &m : scene_.materials) names.push_back(m.name);
    row.complain("material", "no [[material]] is named '" + name + "'" + did_you_mean(name, names));
    return 0;
  }
  if (!named && !plain) {
    row.require("material", "the name of a [[material]], or reflectance = a number or [r, g, b]");
    return 0;
  }
  MaterialScene material;
  material.place = row.place();
  read_colour(row, "reflectance", material.reflectance, {0, 1});
  scene_.materials.push_back(material);
  return static_cast<int>(scene_.materials.size() - 1);
}

}  // namespace greenray
