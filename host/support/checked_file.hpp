// Binary files that say what they are and whether they are whole: checkpoints and parts of pictures.
#pragma once
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <type_traits>
#include <vector>

#include "support/atomic_file.hpp"

namespace greenray {

/// FNV-1a over 64-bit words, the last one filled up with zeros: the same in whatever pieces the bytes come.
class Checksum {
 public:
  void add(const void *bytes, std::size_t count);
  std::uint64_t value() const;

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u, word_ = 0;
  std::size_t filled_ = 0;  // bytes of word_
};

/* A file: a line of text that names its kind, a JSON text with its length (64 bits), arrays whose lengths that text
   tells, a checksum of all before. Numbers as this machine has them; another byte order fails the checksum. */
class CheckedWriter {
 public:
  CheckedWriter(AtomicFile &file, const std::string &kind, const std::string &json);
  void add(const void *bytes, std::size_t count);
  template <class T>
  void add(const std::vector<T> &values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(values.data(), values.size() * sizeof(T));
  }
  /// The checksum; then nothing more.
  void end();

 private:
  AtomicFile &file_;
  Checksum sum_;
};

class CheckedReader {
 public:
  /// errors: InputError if it is missing or of another kind. what: "a checkpoint of this version"; else_do: added to
  /// the complaint, may be empty
  CheckedReader(std::filesystem::path path, const std::string &kind, std::string what, std::string else_do);
  const std::string &json() const { return json_; }
  void take(void *bytes, std::size_t count);
  template <class T>
  void take(std::vector<T> &values, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (count > left_ / sizeof(T)) fail();
    values.resize(count);
    take(values.data(), count * sizeof(T));
  }
  /// Is all there and as it was written? To be asked when everything was taken.
  void end();
  /// The same, whatever was taken: reads what is left.
  void end_early();
  std::uintmax_t left() const { return left_; }
  [[noreturn]] void fail() const;

 private:
  std::filesystem::path path_;
  std::string what_, else_do_, json_;
  std::ifstream file_;
  std::uintmax_t left_ = 0;
  Checksum sum_;
};

}  // namespace greenray
