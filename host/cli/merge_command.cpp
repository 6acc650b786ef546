// greenray merge: the parts that `render --shard I/N` made become the picture that one run makes.
#include <algorithm>

#include "cli/render_command.hpp"
#include "cli/room_command.hpp"
#include "render/picture_part.hpp"

namespace greenray::cli {
namespace {

namespace fs = std::filesystem;

/// The command line of `render` that made the parts, with this command's output and flags.
Arguments arguments_of(const PartHead &head, const Arguments &a) {
  std::vector<std::string> words = head.command;
  if (words.empty()) throw InputError({a.positional()[0], 1, 1}, "expected a part that says what it is a part of");
  if (a.has("--report"))
    words.erase(std::remove_if(words.begin(), words.end(),
                               [](const std::string &word) { return word.starts_with("--report="); }),
                words.end());
  words.push_back("--output=" + a.file("--output", ".exr"));
  for (const Flag &flag : merge_command().spec.flags) {
    if (!a.has(flag.name) || flag.name == "--output" || flag.name == "--help") continue;
    words.push_back(flag.value.empty() ? flag.name : flag.name + "=" + a.text(flag.name));
  }
  return Arguments(render_command().spec, words);
}

int merge(const Arguments &a) {
  (void)a.file("--output", ".exr");  // a wrong word is told before the work
  std::vector<fs::path> parts(a.positional().begin(), a.positional().end());
  std::vector<PartHead> heads;
  for (const fs::path &part : parts) heads.push_back(read_part_head(part));
  (void)order_of_parts(parts, heads);
  const Arguments words = arguments_of(heads.front(), a);
  const bool is_room = room_scene_hash(words).has_value();
  if (heads.front().kind == "room" && is_room && merge_room_parts(words, parts)) return 0;
  if (heads.front().kind == "sky" && !is_room) {
    Session session;
    merge_sky_parts(words, parts, session);
    return 0;
  }
  throw InputError({parts.front().string(), 1, 1},
                   "expected the scene that the part was made of: '" + words.positional()[0] + "' is another one now");
}

}  // namespace

Command merge_command() {
  return {with_common({"merge",
                       "PART...",
                       "The picture of all its shares (render --shard I/N), the same as made in one run.",
                       {{"--output", "-o", "OUT.exr", "where to write; .png, .json and .html go beside it", true},
                        {"--report", "", "W", "on | off: OUT.html, as the shares said if not given"}}}),
          merge};
}

}  // namespace greenray::cli
