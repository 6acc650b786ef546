#include "support/ranks.hpp"

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

namespace greenray {

std::string Ranks::from_first(std::string words) {
  std::vector<std::string> out(static_cast<std::size_t>(size()));
  if (first()) out.assign(out.size(), words);
  return exchange(std::move(out)).front();
}

std::vector<std::string> Ranks::at_first(std::string words) {
  std::vector<std::string> out(static_cast<std::size_t>(size()));
  out.front() = std::move(words);
  std::vector<std::string> in = exchange(std::move(out));
  if (!first()) in.clear();
  return in;
}

void Ranks::together(const std::function<void()> &work) {
  int code = 0;
  std::string message;
  std::exception_ptr own;
  try {
    work();
  } catch (const RanksLost &) {
    throw;
  } catch (const Error &error) {
    own = std::current_exception(), code = static_cast<int>(error.exit_code()), message = error.what();
  }
  if (size() > 1) {
    Packer packer;
    packer.add(code), packer.add(message);
    const std::vector<std::string> all =
        exchange(std::vector<std::string>(static_cast<std::size_t>(size()), packer.take()));
    for (int r = 0; r < size(); ++r) {
      Unpacker from(all[static_cast<std::size_t>(r)]);
      from.take(code), from.take(message);
      if (code == 0) continue;
      part();
      const auto exit_code = static_cast<ExitCode>(code);
      if (!first()) throw RanksLost(exit_code);
      if (r == 0) break;
      throw Error(exit_code, "worker " + std::to_string(r) + ": " + message);
    }
  }
  if (own) std::rethrow_exception(own);
}

namespace {

/// Where threads meet: each leaves its letters, waits for all, and takes its own.
class Meeting {
 public:
  explicit Meeting(int size) : size_(static_cast<std::size_t>(size)), letters_(size_) {}

  std::vector<std::string> exchange(std::size_t rank, std::vector<std::string> out) {
    std::unique_lock<std::mutex> guard(lock_);
    letters_[rank] = std::move(out);
    wait_for_all(guard);
    std::vector<std::string> in;
    for (std::size_t r = 0; r < size_; ++r) in.push_back(std::move(letters_[r][rank]));
    wait_for_all(guard);  // before anyone leaves new ones
    return in;
  }
  void abandon() {
    const std::lock_guard<std::mutex> guard(lock_);
    abandoned_ = true;
    changed_.notify_all();
  }

 private:
  void wait_for_all(std::unique_lock<std::mutex> &guard) {
    if (abandoned_) throw RanksLost();
    const std::uint64_t turn = turn_;
    if (++here_ == size_) {
      here_ = 0, ++turn_;
      changed_.notify_all();
      return;
    }
    changed_.wait(guard, [&] { return turn_ != turn || abandoned_; });
    if (turn_ == turn) throw RanksLost();
  }

  std::size_t size_, here_ = 0;
  std::uint64_t turn_ = 0;
  bool abandoned_ = false;
  std::vector<std::vector<std::string>> letters_;
  std::mutex lock_;
  std::condition_variable changed_;
};

class ThreadRank : public Ranks {
 public:
  ThreadRank(Meeting &meeting, int rank, int size) : meeting_(meeting), rank_(rank), size_(size) {}
  int rank() const override { return rank_; }
  int size() const override { return size_; }
  std::vector<std::string> exchange(std::vector<std::string> out) override {
    return meeting_.exchange(static_cast<std::size_t>(rank_), std::move(out));
  }

 private:
  Meeting &meeting_;
  int rank_, size_;
};

}  // namespace

void run_threads(int size, const std::function<void(Ranks &)> &work) {
  Meeting meeting(size);
  std::vector<std::exception_ptr> failures(static_cast<std::size_t>(size));
  const auto run = [&](int rank) {
    try {
      ThreadRank ranks(meeting, rank, size);
      work(ranks);
    } catch (...) {
      failures[static_cast<std::size_t>(rank)] = std::current_exception();
      meeting.abandon();
    }
  };
  std::vector<std::thread> others;
  for (int rank = 1; rank < size; ++rank) others.emplace_back(run, rank);
  run(0);
  for (std::thread &other : others) other.join();
  std::exception_ptr silent;
  for (const std::exception_ptr &failure : failures) {
    if (!failure) continue;
    try {
      std::rethrow_exception(failure);
    } catch (const RanksLost &) {
      if (!silent) silent = failure;
    }
  }
  if (silent) std::rethrow_exception(silent);
}

}  // namespace greenray
