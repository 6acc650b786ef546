// The materials of a scene while it is read.
#pragma once
#include <functional>

#include "scene/room_reader.hpp"

namespace greenray {

class Materials {
 public:
  /// Reads [[material]] rows into scene.materials.
  Materials(const TomlTable &root, const std::string &folder, RoomScene &scene);

  std::optional<int> find(const std::string &name) const;
  /// The material an object's row asks for: `material = "name"`, or `reflectance = ..` for a Lambert surface of its
  /// own.
  int of_row(const TomlTable &row);
  /// Index of a picture in scene.textures; complains when it is missing or of another kind.
  std::optional<int> add_texture(const std::string &name, const SourcePlace &place,
                                 const std::function<void(const std::string &)> &complain);

 private:
  void read(const TomlTable &row, MaterialScene &material);

  std::string folder_;
  RoomScene &scene_;
};

}  // namespace greenray
