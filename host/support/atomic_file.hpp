// Files that appear whole or not at all: everything is written beside the target and renamed when it is safe on disk.
#pragma once
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace greenray {

/* One output file. Bytes go to a temporary `.NAME.PID.tmp` in the target's folder (made if missing) until commit().
   An old target stays untouched until then; the destructor removes an uncommitted temporary and folders made for it.
   errors: every failing system call -> RunError naming the target and the reason. The first failure is remembered
           and thrown again by seal(), because callers such as libraries' destructors may swallow exceptions. */
class AtomicFile {
 public:
  /// target: the file wanted; a symbolic link is followed. Anything but a regular file in its place is refused.
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(const AtomicFile &) = delete;
  AtomicFile &operator=(const AtomicFile &) = delete;

  void write(std::string_view bytes);
  void write(const void *bytes, std::size_t count);
  void seek(std::uint64_t position);
  std::uint64_t position() const { return position_; }

  const std::filesystem::path &target() const { return target_; }
  const std::filesystem::path &temporary() const { return temporary_; }

  /// Flush, fsync and close the temporary: after this only the rename is left. Repeatable.
  void seal();
  /// seal, rename over the target, fsync the folder. Nothing happens on a second call.
  void commit();

 private:
  friend class AtomicFileSet;
  void make_folder();
  void remove_made_folders();
  enum class State { open, sealed, committed, failed };
  void open_temporary();
  [[noreturn]] void fail(int error_number);
  void rename_to_target();
  void close_stream();

  std::filesystem::path target_, temporary_;
  std::vector<std::filesystem::path> made_folders_;  // outermost first; removed again, if empty, without a commit
  std::FILE *stream_ = nullptr;
  std::uint64_t position_ = 0, size_ = 0;  // size_: bytes wanted so far
  bool had_old_target_ = false;
  State state_ = State::open;
  std::string failure_;
};

/* The files of one picture: all are safely in temporaries before the first is renamed, so a full disk leaves every
   old file in place. If a rename itself fails, those already done are taken back where the file system has hard links.
 */
class AtomicFileSet {
 public:
  AtomicFileSet() = default;
  ~AtomicFileSet();  // last added first removed: the first one may have made the folder
  AtomicFileSet(const AtomicFileSet &) = delete;
  AtomicFileSet &operator=(const AtomicFileSet &) = delete;
  AtomicFile &add(std::filesystem::path target);
  void commit();

 private:
  std::vector<std::unique_ptr<AtomicFile>> files_;
};

/// The whole of `bytes` becomes the file at `path`, or RunError and the old file stays.
void write_file_atomically(const std::filesystem::path &path, std::string_view bytes);

}  // namespace greenray
