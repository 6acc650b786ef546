#include "render/room_checkpoint.hpp"

#include <signal.h>

#include <cerrno>
#include <nlohmann/json.hpp>

#include "support/checked_file.hpp"
#include "support/error.hpp"
#include "support/version.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const std::string kind = "greenray checkpoint 2";

std::string words(const std::array<int, 4> &crop) {
  std::string text;
  for (const int x : crop) text += (text.empty() ? "" : ",") + std::to_string(x);
  return text;
}

}  // namespace

PictureIdentity room_identity(const RoomScene &scene, const RoomOptions &options, const RoomPlan &plan,
                              const std::string &lanes) {
  const bool open = options.error_pct || options.minutes;
  const auto number = [](const auto &value) { return value ? std::to_string(*value) : std::string("not given"); };
  return {room_hash(scene),
          scene.values,
          {{"version", version()},
           {"--seed", std::to_string(options.seed)},
           {"--lanes", lanes},
           {"--straight", options.straight ? "yes" : "no"},
           {"--size", std::to_string(plan.size[0]) + "x" + std::to_string(plan.size[1])},
           {"--crop", words(plan.crop)},
           // Of a run to an error or a time these are only limits, and both may change.
           {"--error or --minutes", open ? "given" : "not given"},
           {"--photons", open ? "" : number(options.photons)},
           {"--spp", open ? "" : number(options.spp)}}};
}

void write_checkpoint(const fs::path &path, const RoomCheckpoint &checkpoint) {
  const RoomState &s = checkpoint.state;
  const Json head{{"scene_hash", checkpoint.identity.scene_hash},
                  {"values", checkpoint.identity.values},
                  {"options", checkpoint.identity.options},
                  {"passes", s.passes},
                  {"pixels", s.tally.whole().pixels.pixels()},
                  {"waves", s.tally.whole().pixels.waves()},
                  {"block_passes", s.tally.block_passes()},
                  {"counts", s.beginning.counts()},
                  {"seconds", s.seconds}};
  AtomicFile file(path);
  CheckedWriter writer(file, kind, head.dump());
  s.beginning.write(writer);
  s.tally.write(writer);
  writer.end();
  file.commit();
}

std::optional<RoomCheckpoint> read_checkpoint(const fs::path &path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  CheckedReader reader(path, kind, "a checkpoint of this version", "--no-resume starts anew");
  RoomCheckpoint out;
  RoomState &s = out.state;
  try {
    const Json head = Json::parse(reader.json());
    out.identity = {head.at("scene_hash"), head.at("values"), head.at("options")};
    s.passes = head.at("passes"), s.seconds = head.at("seconds");
    const std::size_t pixels = head.at("pixels"), waves = head.at("waves");
    const int block_passes = head.at("block_passes");
    // Sums of eight bytes: a file that tells of more than it holds is not asked to make room for them.
    if (waves == 0 || waves > reader.left() || pixels > reader.left() / (waves + 5) / sizeof(double)) reader.fail();
    s.beginning.read(reader, head.at("counts"));
    s.tally = BlockedTally(pixels, waves, block_passes);
    s.tally.read(reader);
  } catch (const Json::exception &) {
    reader.fail();
  } catch (const RunError &) {
    reader.fail();
  }
  reader.end();
  if (s.passes != s.tally.passes()) reader.fail();
  return out;
}

void remove_stale_temporaries(const fs::path &target) {
  std::error_code error;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const std::string stem = "." + target.filename().string() + ".";
  for (const auto &entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(stem, 0) != 0 || !(name.ends_with(".tmp") || name.ends_with(".tmp.old"))) continue;
    const std::string number = name.substr(stem.size(), name.find('.', stem.size()) - stem.size());
    if (number.empty() || number.size() > 9 || number.find_first_not_of("0123456789") != std::string::npos) continue;
    if (::kill(std::stoi(number), 0) != 0 && errno == ESRCH) fs::remove(entry.path(), error);
  }
}

void remove_checkpoint(const fs::path &path) {
  std::error_code error;
  fs::remove(path, error);
  remove_stale_temporaries(path);
}

}  // namespace greenray
