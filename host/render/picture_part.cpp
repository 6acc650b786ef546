#include "render/picture_part.hpp"

#include <nlohmann/json.hpp>

#include "support/checked_file.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

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

}  // namespace

std::vector<std::string> changed_keys(const PictureIdentity &then, const PictureIdentity &now) {
  std::vector<std::string> changed;
  if (then.scene_hash != now.scene_hash) {
    compare(then.values, now.values, changed);
    if (changed.empty()) changed.push_back("the contents of a mesh, texture or profile file changed");
  }
  compare(then.options, now.options, changed);
  return changed;
}

fs::path part_path(const fs::path &exr, const PictureShare &share) {
  return fs::path(exr).replace_extension("." + std::to_string(share.index + 1) + "-of-" + std::to_string(share.count) +
                                         ".grck");
}

const std::string part_kind = "greenray part 1";

std::string head_json(const PartHead &head, const std::string &more_json) {
  return Json{{"kind", head.kind},
              {"share", {head.share.index, head.share.count}},
              {"scene_hash", head.identity.scene_hash},
              {"values", head.identity.values},
              {"options", head.identity.options},
              {"complete", head.complete},
              {"command", head.command},
              {"device", Json::parse(head.device_json)},
              {"report", Json::parse(head.report_json)},
              {"more", Json::parse(more_json)}}
      .dump();
}

PartHead parse_head(const std::string &json, std::string &more_json) {
  const Json j = Json::parse(json);
  PartHead head;
  head.kind = j.at("kind");
  head.share = {j.at("share").at(0), j.at("share").at(1)};
  head.identity = {j.at("scene_hash"), j.at("values"), j.at("options")};
  head.complete = j.at("complete");
  head.command = j.at("command").get<std::vector<std::string>>();
  head.device_json = j.at("device").dump(), head.report_json = j.at("report").dump();
  more_json = j.at("more").dump();
  return head;
}

PartHead read_part_head(const fs::path &path) {
  CheckedReader reader(path, part_kind, "a part of a picture made by this version with --shard", "");
  try {
    std::string more;
    PartHead head = parse_head(reader.json(), more);
    reader.end_early();
    if (head.share.count < 1 || head.share.count > PictureShare::most) reader.fail();
    return head;
  } catch (const Json::exception &) {
    reader.fail();
  }
}

std::vector<std::size_t> order_of_parts(const std::vector<fs::path> &paths, const std::vector<PartHead> &heads) {
  std::vector<Diagnostic> wrong;
  const auto complain = [&](std::size_t i, const std::string &words) {
    wrong.push_back({{paths[i].string(), 1, 1}, words});
  };
  const int count = heads.front().share.count;
  constexpr std::size_t none = ~std::size_t{0};
  std::vector<std::size_t> order(static_cast<std::size_t>(std::max(count, 1)), none);
  for (std::size_t i = 0; i < heads.size(); ++i) {
    const PartHead &head = heads[i];
    for (const std::string &key : changed_keys(heads.front().identity, head.identity))
      complain(i, "expected a part of the same picture as " + paths.front().string() + ": " + key);
    if (head.share.count != count || head.kind != heads.front().kind) {
      complain(i, "expected a share of " + std::to_string(count) + ", found " + head.share.words());
      continue;
    }
    if (head.share.index < 0 || head.share.index >= count) {
      complain(i, "expected a share from 1 to " + std::to_string(count) + ", found " + head.share.words());
      continue;
    }
    if (!head.complete)
      complain(i, "share " + head.share.words() + " is not finished: the same `greenray render` goes on with it");
    std::size_t &place = order[static_cast<std::size_t>(head.share.index)];
    if (place != none) complain(i, "share " + head.share.words() + " is given twice, also as " + paths[place].string());
    place = i;
  }
  std::string missing;
  for (int i = 0; i < count; ++i)
    if (order[static_cast<std::size_t>(i)] == none)
      missing += (missing.empty() ? "" : ", ") + PictureShare{i, count}.words();
  if (!missing.empty() && wrong.empty()) complain(0, "expected all shares of this picture, missing " + missing);
  if (!wrong.empty()) throw InputError(wrong);
  return order;
}

}  // namespace greenray
