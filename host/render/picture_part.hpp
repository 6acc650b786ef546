// What a picture is, to tell whether two runs make the same one, and shares of it (--shard I/N).
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace greenray {

/// What makes a picture's bits: the scene's keys, the options and the program.
struct PictureIdentity {
  std::string scene_hash;
  std::map<std::string, std::string> values;  // of the scene
  std::map<std::string, std::string> options;
};

/// "photons.gather was 150, is 100": what of `then` is not so now and changes the picture; empty: it is the same.
std::vector<std::string> changed_keys(const PictureIdentity &then, const PictureIdentity &now);

/// Share index (from 0) of count.
struct PictureShare {
  int index = 0, count = 1;
  static constexpr int most = 65536;
  std::string words() const { return std::to_string(index + 1) + "/" + std::to_string(count); }
  bool operator==(const PictureShare &) const = default;
};

/// Where the part of a share lies: OUT.exr -> OUT.2-of-3.grck
std::filesystem::path part_path(const std::filesystem::path &exr, const PictureShare &share);

/// The beginning of every part file, whatever is in it.
struct PartHead {
  std::string kind;  // "room", "sky"
  PictureShare share;
  PictureIdentity identity;
  bool complete = false;
  std::vector<std::string> command;  // words of `greenray render` that made it, but for the output and the share
  std::string device_json, report_json;
};

extern const std::string part_kind;  // first line of the file
std::string head_json(const PartHead &head, const std::string &more_json);
/// more_json: what `head_json` was given. errors: nlohmann::json::exception
PartHead parse_head(const std::string &json, std::string &more_json);
/// Only the head, though all is read. errors: InputError if it is no part or damaged anywhere
PartHead read_part_head(const std::filesystem::path &path);

/* Are these all parts of one picture, each once and complete? Then their numbers in the order of their shares.
   errors: InputError with every complaint at once, each naming its file */
std::vector<std::size_t> order_of_parts(const std::vector<std::filesystem::path> &paths,
                                        const std::vector<PartHead> &heads);

}  // namespace greenray
