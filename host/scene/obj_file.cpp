#include "scene/obj_file.hpp"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "scene/obj_check.hpp"

namespace greenray {
namespace {

constexpr std::size_t most_complaints = 20;

class Reader {
 public:
  Reader(const std::string &file, const FindText &find) : file_(file), find_(find) {}

  ObjMesh read(const std::string &text) {
    lines_ = check_obj(file_, text, diagnostics_);
    if (!diagnostics_.empty()) throw InputError(diagnostics_);
    tinyobj::callback_t callback;
    callback.vertex_cb = [](void *me, double x, double y, double z, double) { self(me).places_.push_back({x, y, z}); };
    callback.normal_cb = [](void *me, double x, double y, double z) { self(me).normals_.push_back(unit({x, y, z})); };
    callback.texcoord_cb = [](void *me, double u, double v, double) { self(me).textures_.push_back({u, v}); };
    callback.usemtl_cb = [](void *me, const char *name, int) { self(me).use(name); };
    callback.index_cb = [](void *me, tinyobj::index_t *corners, int count) { self(me).face(corners, count); };
    MtlReader materials(*this);
    std::istringstream stream(text);
    std::string warning, error;
    const bool done = tinyobj::LoadObjWithCallback(stream, callback, this, &materials, &warning, &error);
    if (!done || !error.empty()) complain(1, "not a valid OBJ file: " + error);
    if (!diagnostics_.empty()) throw InputError(diagnostics_);
    return std::move(mesh_);
  }

 private:
  static Reader &self(void *me) { return *static_cast<Reader *>(me); }

  /// tinyobjloader asks for each mtllib here.
  struct MtlReader : tinyobj::MaterialReader {
    explicit MtlReader(Reader &reader) : owner(reader) {}
    bool operator()(const std::string &name, std::vector<tinyobj::material_t> *materials,
                    std::map<std::string, int> *ids, std::string *warning, std::string *error) override {
      const std::optional<std::string> text = owner.find_(name);
      if (!text) {
        const int line = owner.lines_.libraries.empty()
                             ? 1
                             : owner.lines_.libraries[std::min(libraries, owner.lines_.libraries.size() - 1)];
        owner.complain(line, "expected a material file beside this one, found no '" + name + "'");
        return true;
      }
      ++libraries;
      owner.material_lines_ = check_mtl(name, *text, owner.diagnostics_);
      std::istringstream stream(*text);
      const std::size_t before = materials->size();
      tinyobj::LoadMtl(ids, materials, &stream, warning, error);
      for (std::size_t i = before; i < materials->size(); ++i) owner.take_material((*materials)[i], name);
      return true;
    }
    Reader &owner;
    std::size_t libraries = 0;
  };

  void complain(int line, const std::string &message) {
    if (diagnostics_.size() < most_complaints) diagnostics_.push_back({{file_, line, 1}, message});
  }

  void use(const std::string &name) {
    const int line = uses_ < lines_.uses.size() ? lines_.uses[uses_] : 1;
    ++uses_;
    const auto at = std::find(mesh_.material_names.begin(), mesh_.material_names.end(), name);
    material_ = static_cast<int>(at - mesh_.material_names.begin());
    if (at != mesh_.material_names.end()) return;
    mesh_.material_names.push_back(name);
    mesh_.material_places.push_back({file_, line, 1});
  }

  /// Index of a corner's part from the file's number (from 1, or negative from the end), or nothing when it is wrong.
  template <class T>
  std::optional<std::size_t> resolve(int number, const std::vector<T> &list, const char *what, int line) {
    const auto count = static_cast<int>(list.size());
    const int index = number > 0 ? number - 1 : count + number;
    if (number != 0 && index >= 0 && index < count) return static_cast<std::size_t>(index);
    complain(line, "expected a number of a " + std::string(what) + " above, 1 to " + std::to_string(count) +
                       ", found " + std::to_string(number));
    return std::nullopt;
  }

  struct Corner {
    Triple place{}, normal{};
    std::array<double, 2> texture{};
  };

  void face(const tinyobj::index_t *numbers, int count) {
    const int line = faces_ < lines_.faces.size() ? lines_.faces[faces_] : 1;
    ++faces_;
    if (count < 3) return complain(line, "expected a face of at least three corners, found " + std::to_string(count));
    std::vector<Corner> corners;
    for (int i = 0; i < count; ++i) {
      const tinyobj::index_t &n = numbers[i];
      Corner corner;
      const auto place = resolve(n.vertex_index, places_, "vertex (v)", line);
      if (!place) return;
      corner.place = places_[*place];
      if (n.normal_index != 0) {
        const auto normal = resolve(n.normal_index, normals_, "normal (vn)", line);
        if (!normal) return;
        corner.normal = normals_[*normal];
      }
      if (n.texcoord_index != 0) {
        const auto texture = resolve(n.texcoord_index, textures_, "texture place (vt)", line);
        if (!texture) return;
        corner.texture = textures_[*texture];
      }
      corners.push_back(corner);
    }
    if (material_ < 0) use_nothing();
    cut(corners, line);
  }

  void use_nothing() {
    material_ = static_cast<int>(mesh_.material_names.size());
    mesh_.material_names.emplace_back();
    mesh_.material_places.push_back({file_, lines_.faces.empty() ? 1 : lines_.faces.front(), 1});
  }

  void add(const Corner &a, const Corner &b, const Corner &c) {
    mesh_.triangles.push_back({{a.place, b.place, c.place},
                               {a.normal, b.normal, c.normal},
                               {a.texture, b.texture, c.texture},
                               material_,
                               -1});
  }

  /// Ears off until a triangle is left. source: Meisters, "Polygons have ears", Amer. Math. Monthly 82 (1975)
  void cut(std::vector<Corner> corners, int line) {
    Triple area{0, 0, 0};
    double span = 0;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
      const Triple a = corners[i].place - corners[0].place, b = corners[i + 1].place - corners[0].place;
      area = area + cross(a, b);
      span = std::max({span, length(a), length(b)});
    }
    if (!(length(area) > 1e-12 * span * span))
      return complain(line, "expected a face with an area: its corners lie on a line or in a point");
    while (corners.size() > 3) {
      std::size_t ear = 0;
      double best = -1e300;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const double quality = ear_quality(corners, i, area);
        if (quality > best) best = quality, ear = i;
      }
      const std::size_t n = corners.size(), before = (ear + n - 1) % n, after = (ear + 1) % n;
      add(corners[before], corners[ear], corners[after]);
      corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    add(corners[0], corners[1], corners[2]);
    // A cut that is a needle of no area (corners in line) holds nothing and would be no triangle.
    const auto has_no_area = [&](const Triangle &t) { return !(length(t.area_vector_m2()) > 1e-14 * span * span); };
    const auto first =
        mesh_.triangles.end() - static_cast<std::ptrdiff_t>(std::min<std::size_t>(mesh_.triangles.size(), 64));
    mesh_.triangles.erase(std::remove_if(first, mesh_.triangles.end(), has_no_area), mesh_.triangles.end());
  }

  /// Area of the ear at a corner over its longest side squared: negative for reflex corners and ears with corners in
  /// them.
  static double ear_quality(const std::vector<Corner> &corners, std::size_t i, const Triple &area) {
    const std::size_t n = corners.size(), b = (i + n - 1) % n, a = (i + 1) % n;
    const Triple &p = corners[b].place, &q = corners[i].place, &r = corners[a].place, up = unit(area);
    const auto side = [&](const Triple &from, const Triple &to, const Triple &x) {
      return dot(cross(to - from, x - from), up);
    };
    const double size = side(p, q, r);
    for (std::size_t k = 0; k < n; ++k) {
      if (k == i || k == a || k == b) continue;
      const Triple &x = corners[k].place;
      if (size > 0 && side(p, q, x) >= 0 && side(q, r, x) >= 0 && side(r, p, x) > 0) return -1;
    }
    const double longest = std::max({length(q - p), length(r - q), length(p - r)});
    return longest > 0 ? size / (longest * longest) : 0;
  }

  static std::array<double, 3> triple(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

  /// source: MTL's illumination models: 3, 5 and 8 mirror; 4, 6, 7 and 9, or d < 1, glass
  void take_material(const tinyobj::material_t &m, const std::string &file) {
    if (m.name.empty()) return;  // tinyobjloader's own default
    MtlMaterial out;
    out.material.name = m.name;
    const auto line = material_lines_.find(m.name);
    out.material.place = {file, line == material_lines_.end() ? 1 : line->second, 1};
    using Kind = MaterialScene::Kind;
    const bool mirror = m.illum == 3 || m.illum == 5 || m.illum == 8;
    const bool glass = m.illum == 4 || m.illum == 6 || m.illum == 7 || m.illum == 9 || m.dissolve < 1;
    out.material.kind = glass ? Kind::dielectric : mirror ? Kind::mirror : Kind::lambert;
    out.material.reflectance = {Colour::Kind::rgb, mirror ? triple(m.specular) : triple(m.diffuse), 6500};
    if (glass) out.material.index.b = {m.ior > 1 ? m.ior : 1.5};
    out.texture = m.diffuse_texname;
    out.emitted = triple(m.emission);
    mesh_.materials.push_back(out);
  }

  std::string file_;
  const FindText &find_;
  ObjLines lines_;
  std::map<std::string, int> material_lines_;  // of the library that is read
  std::size_t faces_ = 0, uses_ = 0;
  int material_ = -1;
  std::vector<Triple> places_, normals_;
  std::vector<std::array<double, 2>> textures_;
  ObjMesh mesh_;
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace

ObjMesh parse_obj(const std::string &file, const std::string &text, const FindText &find) {
  return Reader(file, find).read(text);
}

}  // namespace greenray
