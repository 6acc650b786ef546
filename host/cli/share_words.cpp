#include "cli/share_words.hpp"

#include <algorithm>
#include <charconv>
#include <iostream>
#include <nlohmann/json.hpp>

#include "cli/render_command.hpp"
#include "render/room_checkpoint.hpp"

namespace greenray::cli {
namespace {

const std::vector<std::string> not_kept{"--output", "--shard", "--resume", "--no-resume", "--checkpoint"};

std::optional<int> whole_number(std::string_view text) {
  int value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<PictureShare> share_from(const Arguments &a) {
  if (!a.has("--shard")) return std::nullopt;
  const std::string text = a.text("--shard");
  const std::size_t slash = text.find('/');
  const auto index = whole_number(std::string_view(text).substr(0, slash));
  const auto count = slash == std::string::npos ? std::nullopt : whole_number(std::string_view(text).substr(slash + 1));
  if (!index || !count || *index < 1 || *count < *index || *count > PictureShare::most)
    a.fail("--shard",
           "expected I/N, share I of N, 1/1 to " + PictureShare{PictureShare::most - 1, PictureShare::most}.words());
  return PictureShare{*index - 1, *count};
}

std::vector<std::string> words_without_share(const Arguments &a) {
  std::vector<std::string> words{a.positional()[0]};
  for (const Flag &flag : render_flags()) {
    if (!a.has(flag.name) || std::find(not_kept.begin(), not_kept.end(), flag.name) != not_kept.end()) continue;
    if (flag.value.empty()) words.push_back(flag.name);
    else
      for (const std::string &value : a.all(flag.name)) words.push_back(flag.name + "=" + value);
  }
  return words;
}

void tell_share(const Arguments &a, const PictureShare &share, const std::filesystem::path &part, int resumed_at) {
  if (a.has("--json"))
    std::cout << nlohmann::json{{"event", "done"}, {"share", share.words()}, {"part", part.string()}}.dump() << "\n";
  else if (!a.has("--quiet"))
    std::cout << "wrote    " << part.string() << (resumed_at > 0 ? ", begun before" : "")
              << "; with all shares: greenray merge OUT.*-of-" << share.count << ".grck -o OUT.exr\n";
}

void remove_stale_outputs(const std::filesystem::path &exr) {
  for (const char *extension : {".exr", ".png", ".json", ".html", ".grck", ".photons.exr", ".photons.png"})
    remove_stale_temporaries(std::filesystem::path(exr).replace_extension(extension));
}

}  // namespace greenray::cli
