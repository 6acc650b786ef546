#include "render/room_checkpoint.hpp"

#include <signal.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/atomic_file.hpp"
#include "support/error.hpp"
#include "support/version.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/* The file: magic, length of a JSON text (64 bits), the text, the arrays it announces, a checksum of all before.
   Numbers as this machine has them; another byte order fails the checksum. */
constexpr char magic[] = "greenray checkpoint 1\n";
constexpr std::size_t magic_bytes = sizeof magic - 1, checksum_bytes = 8;
constexpr std::uintmax_t most_bytes = std::uintmax_t{1} << 36;

/// FNV-1a over 64-bit words, the last one filled up with zeros.
class Checksum {
 public:
  void add(const void *bytes, std::size_t count) {
    const char *from = static_cast<const char *>(bytes);
    for (std::size_t i = 0; i < count; i += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, from + i, std::min<std::size_t>(8, count - i));
      hash_ = (hash_ ^ word) * 0x100000001b3u;
      hash_ ^= hash_ >> 29;
    }
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

class Writer {
 public:
  explicit Writer(AtomicFile &file) : file_(file) {}
  void add(const void *bytes, std::size_t count) { file_.write(bytes, count), sum_.add(bytes, count); }
  template <class T>
  void add(const std::vector<T> &values) {
    add(values.data(), values.size() * sizeof(T));
  }
  void end() {
    const std::uint64_t sum = sum_.value();
    file_.write(&sum, sizeof sum);
  }

 private:
  AtomicFile &file_;
  Checksum sum_;
};

class Reader {
 public:
  explicit Reader(const fs::path &path) : path_(path), file_(path, std::ios::binary) {
    file_.seekg(0, std::ios::end);
    left_ = static_cast<std::uintmax_t>(std::max<std::streamoff>(file_.tellg(), 0));
    file_.seekg(0);
  }
  [[noreturn]] void fail() const {
    throw InputError({path_.string(), 1, 1},
                     "expected a checkpoint of this version, found a damaged or another file; --no-resume starts anew");
  }
  void take(void *bytes, std::size_t count) {
    if (count > left_ || !file_.read(static_cast<char *>(bytes), static_cast<std::streamsize>(count))) fail();
    left_ -= count;
    sum_.add(bytes, count);
  }
  template <class T>
  void take(std::vector<T> &values, std::size_t count) {
    if (left_ > most_bytes || count > left_ / sizeof(T)) fail();
    values.resize(count);
    take(values.data(), count * sizeof(T));
  }
  void end() {
    const std::uint64_t expected = sum_.value();
    std::uint64_t found = 0;
    take(&found, sizeof found);
    if (found != expected || left_ != 0) fail();
  }
  std::uintmax_t left() const { return left_; }

 private:
  fs::path path_;
  std::ifstream file_;
  std::uintmax_t left_ = 0;
  Checksum sum_;
};

Json totals_json(const PhotonTotals &t) {
  return {t.emitted, t.absorbed, t.escaped, t.medium, t.dropped, t.photons, t.pieces, t.stored, t.outcome, t.seconds};
}

PhotonTotals totals_from(const Json &j) {
  PhotonTotals t;
  t.emitted = j.at(0), t.absorbed = j.at(1), t.escaped = j.at(2), t.medium = j.at(3), t.dropped = j.at(4);
  t.photons = j.at(5), t.pieces = j.at(6), t.stored = j.at(7), t.outcome = j.at(8), t.seconds = j.at(9);
  return t;
}

/// Keys that leave the radiance as it is.
bool changes_nothing(const std::string &key) {
  return key == "title" || key == "greenray" || key.rfind("output.", 0) == 0 || key.rfind("eye.", 0) == 0 ||
         key == "aovs";
}

void compare(const std::map<std::string, std::string> &then, const std::map<std::string, std::string> &now,
             std::vector<std::string> &changed) {
  const auto value = [](const std::map<std::string, std::string> &of, const std::string &key) {
    const auto at = of.find(key);
    return at == of.end() ? std::string("not given") : at->second;
  };
  std::map<std::string, std::string> keys = then;
  keys.insert(now.begin(), now.end());
  for (const auto &[key, unused] : keys)
    if (!changes_nothing(key) && value(then, key) != value(now, key))
      changed.push_back(key + " was " + value(then, key) + ", is " + value(now, key));
}

std::string words(const std::array<int, 4> &crop) {
  std::string text;
  for (const int x : crop) text += (text.empty() ? "" : ",") + std::to_string(x);
  return text;
}

}  // namespace

RoomIdentity room_identity(const RoomScene &scene, const RoomOptions &options, const RoomPlan &plan) {
  const bool open = options.error_pct || options.minutes;
  const auto number = [](const auto &value) { return value ? std::to_string(*value) : std::string("not given"); };
  return {room_hash(scene),
          scene.values,
          {{"version", version()},
           {"--seed", std::to_string(options.seed)},
           {"--straight", options.straight ? "yes" : "no"},
           {"--size", std::to_string(plan.size[0]) + "x" + std::to_string(plan.size[1])},
           {"--crop", words(plan.crop)},
           // Of a run to an error or a time these are only limits, and both may change.
           {"--error or --minutes", open ? "given" : "not given"},
           {"--photons", open ? "" : number(options.photons)},
           {"--spp", open ? "" : number(options.spp)}}};
}

std::vector<std::string> changed_keys(const RoomIdentity &then, const RoomIdentity &now) {
  std::vector<std::string> changed;
  if (then.scene_hash != now.scene_hash) {
    compare(then.values, now.values, changed);
    if (changed.empty()) changed.push_back("the contents of a mesh, texture or profile file changed");
  }
  compare(then.options, now.options, changed);
  return changed;
}

void write_checkpoint(const fs::path &path, const RoomCheckpoint &checkpoint) {
  const RoomState &s = checkpoint.state;
  const std::string text =
      Json{{"scene_hash", checkpoint.identity.scene_hash},
           {"values", checkpoint.identity.values},
           {"options", checkpoint.identity.options},
           {"passes", s.passes},
           {"photons_a_pass", s.photons_a_pass},
           {"photons", totals_json(s.photons)},
           {"seconds", s.seconds},
           {"counts", {s.statistics.size(), s.radii.size(), s.sums.size(), s.lamp_pixels.size(), s.edge_pixels.size()}}}
          .dump();
  AtomicFile file(path);
  Writer writer(file);
  const std::uint64_t length = text.size();
  writer.add(magic, magic_bytes);
  writer.add(&length, sizeof length);
  writer.add(text.data(), text.size());
  writer.add(s.statistics), writer.add(s.radii), writer.add(s.sums), writer.add(s.lamp_pixels);
  writer.add(s.edge_pixels);
  writer.end();
  file.commit();
}

std::optional<RoomCheckpoint> read_checkpoint(const fs::path &path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  Reader reader(path);
  char start[magic_bytes];
  reader.take(start, magic_bytes);
  if (std::memcmp(start, magic, magic_bytes) != 0) reader.fail();
  std::uint64_t length = 0;
  reader.take(&length, sizeof length);
  std::vector<char> text;
  reader.take(text, static_cast<std::size_t>(std::min<std::uint64_t>(length, reader.left() + 1)));
  RoomCheckpoint out;
  RoomState &s = out.state;
  try {
    const Json head = Json::parse(text.begin(), text.end());
    out.identity = {head.at("scene_hash"), head.at("values"), head.at("options")};
    s.passes = head.at("passes"), s.photons_a_pass = head.at("photons_a_pass"), s.seconds = head.at("seconds");
    s.photons = totals_from(head.at("photons"));
    const std::vector<std::size_t> counts = head.at("counts");
    reader.take(s.statistics, counts.at(0)), reader.take(s.radii, counts.at(1));
    reader.take(s.sums, counts.at(2)), reader.take(s.lamp_pixels, counts.at(3));
    reader.take(s.edge_pixels, counts.at(4));
  } catch (const Json::exception &) {
    reader.fail();
  } catch (const std::out_of_range &) {
    reader.fail();
  }
  reader.end();
  return out;
}

void remove_stale_temporaries(const fs::path &target) {
  std::error_code error;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const std::string stem = "." + target.filename().string() + ".";
  for (const auto &entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(stem, 0) != 0 || entry.path().extension() != ".tmp") continue;
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
