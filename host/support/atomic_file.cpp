#include "support/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "support/error.hpp"

namespace greenray {
namespace fs = std::filesystem;

namespace {

std::string cannot_write(const fs::path &target, const std::string &reason) {
  return "cannot write " + target.string() + ": " + reason;
}

std::string megabytes(std::uint64_t bytes) {
  const std::uint64_t tenths = std::max<std::uint64_t>((bytes + 99'999) / 100'000, 1);
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " MB";
}

bool is_picture(const fs::path &target) { return target.extension() == ".exr" || target.extension() == ".png"; }

/// Not every file system can fsync a folder; the rename has happened by then, so this is best effort.
void sync_folder(const fs::path &target) {
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)) {
  if (!target_.has_filename()) throw RunError(cannot_write(target_, "a file name is missing"));
  std::error_code error;
  if (fs::is_symlink(target_, error)) {
    const fs::path followed = fs::weakly_canonical(target_, error);
    if (!error) target_ = followed;
  }
  const fs::file_status status = fs::status(target_, error);
  if (fs::is_directory(status)) throw RunError(cannot_write(target_, "it is a folder"));
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw RunError(cannot_write(target_, "it is not a regular file"));
  had_old_target_ = fs::exists(status);
  try {
    make_folder();
    open_temporary();
  } catch (...) {
    remove_made_folders();
    throw;
  }
}

AtomicFile::~AtomicFile() {
  close_stream();
  if (state_ == State::committed) return;
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  remove_made_folders();
}

void AtomicFile::make_folder() {
  const fs::path folder = target_.parent_path();
  std::error_code error;
  for (fs::path missing = folder; !missing.empty() && !fs::exists(fs::symlink_status(missing, error));
       missing = missing.parent_path())
    made_folders_.insert(made_folders_.begin(), missing);
  if (made_folders_.empty() && (folder.empty() || fs::is_directory(folder, error))) return;
  fs::create_directories(folder, error);
  if (error && !fs::is_directory(folder))
    throw RunError(cannot_write(target_, "no folder " + folder.string() + " (" + error.message() + ")"));
}

/// A folder that others write into is not empty and stays.
void AtomicFile::remove_made_folders() {
  for (auto folder = made_folders_.rbegin(); folder != made_folders_.rend(); ++folder) ::rmdir(folder->c_str());
}

void AtomicFile::open_temporary() {
  const std::string stem = "." + target_.filename().string() + "." + std::to_string(::getpid());
  for (int attempt = 0; attempt < 100; ++attempt) {  // a name is taken when two writers of this process share a target
    const fs::path candidate = target_.parent_path() / (stem + (attempt ? "." + std::to_string(attempt) : "") + ".tmp");
    const int descriptor = ::open(candidate.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno == EEXIST) continue;
    if (descriptor < 0) fail(errno);
    temporary_ = candidate;
    stream_ = ::fdopen(descriptor, "w+b");
    if (stream_) return;
    const int error_number = errno;
    ::close(descriptor);
    ::unlink(temporary_.c_str());
    fail(error_number);
  }
  fail(EEXIST);
}

void AtomicFile::fail(int error_number) {
  std::string reason = std::strerror(error_number);
  std::string remarks;
  if (error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG)
    remarks = "needs at least " + megabytes(size_);
  if (had_old_target_)
    remarks +=
        std::string(remarks.empty() ? "" : "; ") + "the old " + (is_picture(target_) ? "picture" : "file") + " is kept";
  if (!remarks.empty()) reason += " (" + remarks + ")";
  state_ = State::failed;
  failure_ = cannot_write(target_, reason);
  throw RunError(failure_);
}

void AtomicFile::write(std::string_view bytes) { write(bytes.data(), bytes.size()); }

void AtomicFile::write(const void *bytes, std::size_t count) {
  if (state_ == State::failed) throw RunError(failure_);
  if (state_ != State::open) throw std::logic_error("AtomicFile: write after seal");
  size_ = std::max(size_, position_ + count);
  errno = 0;
  if (count > 0 && std::fwrite(bytes, 1, count, stream_) != count) fail(errno ? errno : EIO);
  position_ += count;
}

void AtomicFile::seek(std::uint64_t position) {
  if (state_ == State::failed) throw RunError(failure_);
  if (state_ != State::open) throw std::logic_error("AtomicFile: seek after seal");
  if (::fseeko(stream_, static_cast<off_t>(position), SEEK_SET) != 0) fail(errno);  // flushes what was written before
  position_ = position;
}

void AtomicFile::close_stream() {
  if (stream_) std::fclose(stream_);
  stream_ = nullptr;
}

void AtomicFile::seal() {
  if (state_ == State::failed) throw RunError(failure_);
  if (state_ != State::open) return;
  if (std::fflush(stream_) != 0 || ::fsync(::fileno(stream_)) != 0) fail(errno);
  std::FILE *closing = std::exchange(stream_, nullptr);
  if (std::fclose(closing) != 0) fail(errno);
  state_ = State::sealed;
}

void AtomicFile::rename_to_target() {
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(errno);
  state_ = State::committed;
}

void AtomicFile::commit() {
  if (state_ == State::committed) return;
  seal();
  rename_to_target();
  sync_folder(target_);
}

AtomicFileSet::~AtomicFileSet() {
  while (!files_.empty()) files_.pop_back();
}

AtomicFile &AtomicFileSet::add(fs::path target) {
  files_.push_back(std::make_unique<AtomicFile>(std::move(target)));
  return *files_.back();
}

namespace {

/// Keeps the old target alive under a second name until the whole set is renamed.
struct Backup {
  fs::path target, kept;
  bool renamed = false;

  explicit Backup(const AtomicFile &file) : target(file.target()), kept(file.temporary().string() + ".old") {
    if (::link(target.c_str(), kept.c_str()) != 0) kept.clear();
  }
  void take_back(bool had_old_target) const {
    if (!renamed) return;
    if (!kept.empty()) ::rename(kept.c_str(), target.c_str());
    else if (!had_old_target) ::unlink(target.c_str());
  }
  void forget() const {
    if (!kept.empty()) ::unlink(kept.c_str());
  }
};

}  // namespace

void AtomicFileSet::commit() {
  for (const auto &file : files_) file->seal();
  std::vector<Backup> backups;
  backups.reserve(files_.size());
  for (const auto &file : files_)
    if (file->state_ == AtomicFile::State::sealed) backups.emplace_back(*file);
  try {
    std::size_t next = 0;
    for (const auto &file : files_) {
      if (file->state_ != AtomicFile::State::sealed) continue;
      file->rename_to_target();
      backups[next++].renamed = true;
    }
  } catch (...) {
    std::size_t next = 0;
    for (const auto &file : files_) {
      if (next == backups.size() || backups[next].target != file->target()) continue;
      backups[next++].take_back(file->had_old_target_);
    }
    for (const Backup &backup : backups) backup.forget();
    throw;
  }
  for (const Backup &backup : backups) backup.forget();
  for (const auto &file : files_) sync_folder(file->target());
}

void write_file_atomically(const fs::path &path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace greenray
