// greenray scenes and new: what ships, and a commented scene to start from.
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "scene/room_scene.hpp"
#include "scene/scene_file.hpp"
#include "support/atomic_file.hpp"
#include "support/embedded.hpp"

namespace greenray::cli {
namespace {

std::string title_of(const std::string &name) {
  const std::string file = "scenes/" + name + ".toml";
  const std::string text(embedded_file(file).value());
  return is_room_text(file, text) ? parse_room(file, text, {}).title : load_scene(name).title;
}

int list(const Arguments &a) {
  nlohmann::json out = nlohmann::json::array();
  std::string text;
  for (const std::string &name : shipped_scenes()) {
    const std::string title = title_of(name);
    std::string left = name;
    left.resize(std::max<std::size_t>(left.size() + 2, 20), ' ');
    text += left + title + "\n";
    out.push_back({{"name", name}, {"title", title}});
  }
  emit(a, a.has("--json") ? out.dump(1) + "\n" : text);
  return 0;
}

int write_new(const Arguments &a) {
  const std::string file = a.positional()[0];
  if (std::filesystem::path(file).extension() != ".toml")
    throw InputError(a.positional_place(0), "'" + file + "': expected a file name that ends in .toml");
  if (std::filesystem::exists(file))
    throw InputError(a.positional_place(0), "'" + file + "' exists already: expected a new file name");
  const auto text = embedded_file("scenes/template.toml");
  if (!text) throw RunError("scenes/template.toml is not in this binary: a build is broken");
  write_file_atomically(file, *text);
  if (!a.has("--quiet")) std::cout << "wrote    " << file << "   (next: greenray check " << file << ")\n";
  return 0;
}

}  // namespace

Command scenes_command() { return {with_common({"scenes", "", "Lists the scenes that ship.", {}}), list}; }
Command new_command() {
  return {with_common({"new", "FILE.toml", "Writes a commented scene to start from.", {}}), write_new};
}

}  // namespace greenray::cli
