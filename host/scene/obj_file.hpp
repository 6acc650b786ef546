// Wavefront OBJ and MTL, read through tinyobjloader and checked with the lines of the file.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/room_scene.hpp"

namespace greenray {

/// A material of an MTL file, in words of ours.
struct MtlMaterial {
  MaterialScene material;   // reflectance from Kd, Ks (mirror) or Tf; index from Ni
  std::string texture;      // map_Kd, as written
  Triple emitted{0, 0, 0};  // Ke: radiance [W m^-2 sr^-1] as linear Rec. 709; zero: no light
};

struct ObjMesh {
  std::vector<Triangle> triangles;          // material: index into material_names
  std::vector<std::string> material_names;  // in the order of their first use; "" before the first usemtl
  std::vector<SourcePlace> material_places;
  std::vector<MtlMaterial> materials;  // of the MTL files
};

/// Contents of a file that an OBJ names, or nothing; it is asked with the file's name as written.
using FindText = std::function<std::optional<std::string>(const std::string &name)>;

/* Faces of any number of corners (cut by ears where they are not convex), v/vt/vn in every form, negative indices,
   usemtl, mtllib. Lines, points and curves are left out.
   errors: InputError with every complaint at once (at most 20): indices that are 0 or beyond what stands above them,
           fewer than three corners, faces without area, coordinates that are no numbers, a missing MTL file */
ObjMesh parse_obj(const std::string &file, const std::string &text, const FindText &find);

}  // namespace greenray
