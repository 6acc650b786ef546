// Workers that make one picture together, each with a device: threads of this process (--device all) or processes that
// mpirun started. All of them call exchange() in the same order.
#pragma once
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "support/error.hpp"

namespace greenray {

/// Another worker died or failed: there is no one to work with. Says nothing by itself, for that one has spoken.
struct RanksLost : Error {
  explicit RanksLost(ExitCode code = ExitCode::run_failed) : Error(code, "") {}
};

class Ranks {
 public:
  virtual ~Ranks() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;
  /// Sends out[r] to worker r and returns what each sent here, by rank. Blocks until all have come.
  /// errors: RanksLost
  virtual std::vector<std::string> exchange(std::vector<std::string> out) = 0;

  bool first() const { return rank() == 0; }
  /// The same words to all: those of rank 0.
  std::string from_first(std::string words);
  /// All of them at rank 0, nothing elsewhere.
  std::vector<std::string> at_first(std::string words);
  /* Runs `work` here while the others run theirs. If it fails anywhere, all of them throw with the code of the lowest
     rank that failed: rank 0 with its message, the others silently. */
  void together(const std::function<void()> &work);
  /// All of them know that it is over: none waits for another any more.
  void part() { parted_ = true; }
  bool parted() const { return parted_; }

 private:
  bool parted_ = false;
};

/// A worker alone.
class OneRank : public Ranks {
 public:
  int rank() const override { return 0; }
  int size() const override { return 1; }
  std::vector<std::string> exchange(std::vector<std::string> out) override { return out; }
};

/// Values one after the other in a string of bytes, in the machine's own order.
class Packer {
 public:
  template <class T>
  void add(const T &value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char *>(&value), sizeof value);
  }
  void add(const void *from, std::size_t count) { bytes_.append(static_cast<const char *>(from), count); }
  template <class T>
  void add(const std::vector<T> &values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(values.size());
    add(values.data(), values.size() * sizeof(T));
  }
  void add(const std::string &text) { add(text.size()), add(text.data(), text.size()); }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Unpacker {
 public:
  explicit Unpacker(const std::string &bytes) : from_(bytes.data()), left_(bytes.size()) {}
  template <class T>
  void take(T &value) {
    static_assert(std::is_trivially_copyable_v<T>);
    copy(&value, sizeof value);
  }
  void take(void *to, std::size_t count) { copy(to, count); }
  template <class T>
  void take(std::vector<T> &values) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::size_t count = 0;
    take(count);
    if (count > left_ / sizeof(T)) fail();
    values.resize(count);
    copy(values.data(), count * sizeof(T));
  }
  /// As many as were added.
  template <class T>
  void take(std::vector<T> &values, std::size_t count) {
    take(values);
    if (values.size() != count) fail();
  }
  void take(std::string &text) {
    std::size_t count = 0;
    take(count);
    if (count > left_) fail();
    text.resize(count);
    copy(text.data(), count);
  }
  template <class T>
  T get() {
    T value{};
    take(value);
    return value;
  }

 private:
  [[noreturn]] static void fail() { throw RunError("a worker of another version answered"); }
  void copy(void *to, std::size_t count) {
    if (count > left_) fail();
    if (count > 0) std::memcpy(to, from_, count);
    from_ += count, left_ -= count;
  }
  const char *from_;
  std::size_t left_;
};

/* Threads of this process, one a rank; rank 0 is the caller's. work(ranks) runs in each. A thread that throws frees the
   others from their exchanges. errors: those of the lowest rank that failed by itself */
void run_threads(int size, const std::function<void(Ranks &)> &work);

}  // namespace greenray
