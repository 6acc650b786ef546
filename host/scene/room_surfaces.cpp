// [[mesh]], [[quad]], [[box]], [[sphere]]: surfaces in world coordinates.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "scene/obj_file.hpp"
#include "scene/room_materials.hpp"
#include "scene/transform.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;

const Limits anywhere{-1e6, 1e6, "m"};

Transform read_transform(const TomlTable &row) {
  Triple scale{1, 1, 1}, turned_deg{0, 0, 0}, moved_m{0, 0, 0};
  if (row.holds_array("scale")) {
    read_triple(row, "scale", scale, {-1e6, 1e6});
  } else {
    double even = 1;
    if (row.read("scale", even, {-1e6, 1e6})) scale = {even, even, even};
  }
  if (scale[0] * scale[1] * scale[2] == 0) row.complain("scale", "expected factors other than 0");
  read_triple(row, "rotate_deg", turned_deg, {-1e6, 1e6, "deg"});
  read_triple(row, "translate_m", moved_m, anywhere);
  return Transform::of(scale, turned_deg, moved_m);
}

/// The object's own transform, and one for each of its `instances`.
std::vector<Transform> read_transforms(const TomlTable &row) {
  const Transform own = read_transform(row);
  std::vector<Transform> all;
  for (const TomlTable &instance : row.rows("instances")) all.push_back(read_transform(instance).after(own));
  if (!row.has("instances")) all.push_back(own);
  return all;
}

class SurfaceReader {
 public:
  SurfaceReader(TomlDocument &document, const std::string &folder, Materials &materials, RoomScene &scene)
      : document_(document), folder_(folder), materials_(materials), scene_(scene) {}

  void read(const TomlTable &root) {
    for (const TomlTable &row : root.rows("mesh")) read_mesh(row);
    for (const TomlTable &row : root.rows("quad")) read_quad(row);
    for (const TomlTable &row : root.rows("box")) read_box(row);
    for (const TomlTable &row : root.rows("sphere")) read_sphere(row);
    const bool any = root.has("mesh") || root.has("quad") || root.has("box") || root.has("sphere");
    if (!any && root.has("camera"))
      root.complain("camera", "expected something to look at: a [[mesh]], [[quad]], [[box]] or [[sphere]]");
  }
  RoomNames names;

 private:
  /// Adds transformed copies under the row's name.
  void add(const TomlTable &row, const std::vector<Triangle> &triangles) {
    std::string name;
    row.read("name", name);
    for (const Transform &by : read_transforms(row))
      for (const Triangle &t : triangles) {
        if (!name.empty()) names[name].triangles.push_back(scene_.surfaces.triangles.size());
        scene_.surfaces.triangles.push_back(transformed(t, by));
      }
  }

  void read_mesh(const TomlTable &row) {
    std::string file;
    row.require("file", "the name of an OBJ file");
    const bool has_file = row.read("file", file);
    const bool has_own = row.has("material") || row.has("reflectance");
    const int own = has_own ? materials_.of_row(row) : 0;
    bool smooth = true;
    row.read("smooth", smooth);
    std::vector<Triangle> triangles;
    if (has_file) triangles = load(row, file, has_own ? std::optional<int>(own) : std::nullopt);
    if (!smooth)
      for (Triangle &t : triangles) t.corner_normal = {};
    add(row, triangles);
  }

  std::vector<Triangle> load(const TomlTable &row, const std::string &file, std::optional<int> own) {
    const auto found = find_beside(folder_, file, row.place("file"));
    if (!found)
      return row.complain("file", "no such file: '" + (fs::path(folder_) / file).lexically_normal().string() + "'"),
             std::vector<Triangle>{};
    const std::string beside = fs::path(found->path).parent_path().string();
    try {
      ObjMesh mesh = parse_obj(found->path, found->text, [&](const std::string &name) -> std::optional<std::string> {
        const auto text = find_beside(beside, name, row.place("file"));
        return text ? std::optional<std::string>(text->text) : std::nullopt;
      });
      if (mesh.triangles.empty()) row.complain("file", "'" + found->path + "' has no faces");
      std::vector<int> material, light(mesh.material_names.size(), -1);
      for (std::size_t i = 0; i < mesh.material_names.size(); ++i)
        material.push_back(own ? *own : material_of(mesh, i, light[i], row));
      for (Triangle &t : mesh.triangles) {
        t.light = light[static_cast<std::size_t>(t.material)];
        t.material = material[static_cast<std::size_t>(t.material)];
      }
      return std::move(mesh.triangles);
    } catch (const InputError &error) {
      document_.complain(error);
      return {};
    }
  }

  /// A usemtl name: a [[material]] of the scene first, then the MTL's own.
  int material_of(const ObjMesh &mesh, std::size_t i, int &light, const TomlTable &row) {
    const std::string &name = mesh.material_names[i];
    if (const auto found = materials_.find(name)) return *found;
    for (const MtlMaterial &m : mesh.materials) {
      if (m.material.name != name) continue;
      MaterialScene material = m.material;
      if (!m.texture.empty())
        material.texture = materials_.add_texture(
            m.texture, m.material.place, [&](const std::string &what) { document_.complain(m.material.place, what); });
      if (m.emitted != Triple{0, 0, 0}) light = add_light(m);
      scene_.materials.push_back(material);
      return static_cast<int>(scene_.materials.size() - 1);
    }
    if (name.empty())
      document_.complain(row.place("file"),
                         "the mesh has faces without a material: give material = \"name\" or reflectance = .. here");
    else
      document_.complain(mesh.material_places[i],
                         "expected a material of the scene or of an MTL file, found '" + name + "'");
    return 0;
  }

  /// Ke is a radiance; its power follows when the area is known (room_lights.cpp).
  int add_light(const MtlMaterial &m) {
    LightScene light;
    light.kind = LightScene::Kind::area;
    light.colour = {Colour::Kind::rgb, m.emitted, 6500};
    light.power_W = -1;
    light.place = m.material.place;
    scene_.lights.push_back(light);
    return static_cast<int>(scene_.lights.size() - 1);
  }

  void read_quad(const TomlTable &row) {
    Triple corner{}, u{}, v{};
    row.require("corner", "a place, [x, y, z] in m");
    row.require("edge_u", "[x, y, z] in m, from the corner to the next");
    row.require("edge_v", "[x, y, z] in m, from the corner to the one before");
    const bool right = read_triple(row, "corner", corner, anywhere) & read_triple(row, "edge_u", u, anywhere) &
                       read_triple(row, "edge_v", v, anywhere);
    const int material = materials_.of_row(row);
    if (right && length(cross(u, v)) <= 1e-12 * length(u) * length(v))
      row.complain("edge_v", "expected edges that span an area");
    add(row, quad(corner, u, v, material));
  }

  static std::vector<Triangle> quad(const Triple &corner, const Triple &u, const Triple &v, int material) {
    const Triple a = corner, b = corner + u, c = corner + u + v, d = corner + v;
    const std::array<double, 2> ta{0, 0}, tb{1, 0}, tc{1, 1}, td{0, 1};
    return {{{a, b, c}, {}, {ta, tb, tc}, material, -1}, {{a, c, d}, {}, {ta, tc, td}, material, -1}};
  }

  void read_box(const TomlTable &row) {
    Triple low{}, high{};
    row.require("low", "the lowest corner, [x, y, z] in m");
    row.require("high", "the highest corner, [x, y, z] in m");
    const bool right = read_triple(row, "low", low, anywhere) & read_triple(row, "high", high, anywhere);
    bool inward = false;
    row.read("inward", inward);
    const int material = materials_.of_row(row);
    for (std::size_t a = 0; right && a < 3; ++a)
      if (!(high[a] > low[a])) return row.complain("high", "expected a corner above `low` in x, y and z");
    const Triple x{high[0] - low[0], 0, 0}, y{0, high[1] - low[1], 0}, z{0, 0, high[2] - low[2]};
    std::vector<Triangle> faces;
    const auto face = [&](const Triple &corner, const Triple &u, const Triple &v) {
      for (const Triangle &t : quad(corner, inward ? v : u, inward ? u : v, material)) faces.push_back(t);
    };
    face(low, y, x), face(low, z, y), face(low, x, z);
    face(high, Triple{0, 0, 0} - x, Triple{0, 0, 0} - y);
    face(high, Triple{0, 0, 0} - y, Triple{0, 0, 0} - z);
    face(high, Triple{0, 0, 0} - z, Triple{0, 0, 0} - x);
    add(row, right ? faces : std::vector<Triangle>{});
  }

  void read_sphere(const TomlTable &row) {
    Sphere sphere;
    row.require("centre", "a place, [x, y, z] in m");
    row.require("radius_m", "a number above 0 m");
    read_triple(row, "centre", sphere.centre, anywhere);
    row.read("radius_m", sphere.radius_m, {0, 1e6, "m", true});
    sphere.material = materials_.of_row(row);
    std::string name;
    row.read("name", name);
    for (const Transform &by : read_transforms(row)) {
      Sphere copy = sphere;
      copy.centre = by.place(sphere.centre);
      copy.radius_m *= by.even_scale();
      if (by.even_scale() == 0) {
        row.complain("scale", "expected the same factor along x, y and z for a sphere");
        return;
      }
      if (!name.empty()) names[name].spheres.push_back(scene_.surfaces.spheres.size());
      scene_.surfaces.spheres.push_back(copy);
    }
  }

  TomlDocument &document_;
  std::string folder_;
  Materials &materials_;
  RoomScene &scene_;
};

}  // namespace

RoomNames read_room_surfaces(TomlDocument &document, const TomlTable &root, const std::string &folder,
                             RoomScene &scene) {
  Materials materials(root, folder, scene);
  SurfaceReader reader(document, folder, materials, scene);
  reader.read(root);
  return reader.names;
}

}  // namespace greenray
