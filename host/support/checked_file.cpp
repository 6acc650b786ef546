#include "support/checked_file.hpp"

#include <algorithm>

#include "support/error.hpp"

namespace greenray {
namespace {
constexpr std::size_t checksum_bytes = 8;
constexpr std::size_t piece = std::size_t{1} << 20;
constexpr std::uint64_t longest_json = std::uint64_t{1} << 28;
}  // namespace

namespace {
std::uint64_t mixed(std::uint64_t hash, std::uint64_t word) {
  hash = (hash ^ word) * 0x100000001b3u;
  return hash ^ (hash >> 29);
}
}  // namespace

void Checksum::add(const void *bytes, std::size_t count) {
  const char *from = static_cast<const char *>(bytes);
  while (count > 0) {
    if (filled_ == 0 && count >= sizeof word_) {
      std::uint64_t word = 0;
      std::memcpy(&word, from, sizeof word);
      hash_ = mixed(hash_, word);
      from += sizeof word, count -= sizeof word;
      continue;
    }
    const std::size_t some = std::min(count, sizeof word_ - filled_);
    std::memcpy(reinterpret_cast<char *>(&word_) + filled_, from, some);
    from += some, count -= some, filled_ += some;
    if (filled_ < sizeof word_) return;
    hash_ = mixed(hash_, word_);
    word_ = 0, filled_ = 0;
  }
}

std::uint64_t Checksum::value() const { return filled_ > 0 ? mixed(hash_, word_) : hash_; }

CheckedWriter::CheckedWriter(AtomicFile &file, const std::string &kind, const std::string &json) : file_(file) {
  const std::string line = kind + "\n";
  const std::uint64_t length = json.size();
  add(line.data(), line.size());
  add(&length, sizeof length);
  add(json.data(), json.size());
}

void CheckedWriter::add(const void *bytes, std::size_t count) {
  file_.write(bytes, count);
  sum_.add(bytes, count);
}

void CheckedWriter::end() {
  const std::uint64_t sum = sum_.value();
  file_.write(&sum, checksum_bytes);
}

CheckedReader::CheckedReader(std::filesystem::path path, const std::string &kind, std::string what, std::string else_do)
    : path_(std::move(path)), what_(std::move(what)), else_do_(std::move(else_do)), file_(path_, std::ios::binary) {
  std::error_code error;
  if (!file_ || !std::filesystem::is_regular_file(path_, error)) fail();
  left_ = std::filesystem::file_size(path_, error);
  if (error) fail();
  const std::string line = kind + "\n";
  std::string start(line.size(), '\0');
  take(start.data(), start.size());
  if (start != line) fail();
  std::uint64_t length = 0;
  take(&length, sizeof length);
  if (length > std::min<std::uint64_t>(left_, longest_json)) fail();
  json_.resize(length);
  take(json_.data(), length);
}

void CheckedReader::fail() const {
  throw InputError({path_.string(), 1, 1}, "expected " + what_ + ", found a damaged or another file" +
                                               (else_do_.empty() ? "" : "; " + else_do_));
}

void CheckedReader::take(void *bytes, std::size_t count) {
  if (count > left_ || !file_.read(static_cast<char *>(bytes), static_cast<std::streamsize>(count))) fail();
  left_ -= count;
  sum_.add(bytes, count);
}

void CheckedReader::end_early() {
  std::vector<char> bytes;
  while (left_ > checksum_bytes) take(bytes, std::min<std::uintmax_t>(left_ - checksum_bytes, piece));
  end();
}

void CheckedReader::end() {
  const std::uint64_t expected = sum_.value();
  std::uint64_t found = 0;
  take(&found, checksum_bytes);
  if (found != expected || left_ != 0) fail();
}

}  // namespace greenray
