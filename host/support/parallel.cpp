#include "support/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace greenray {

unsigned host_threads() { return std::max(1U, std::thread::hardware_concurrency()); }

void for_pieces(std::size_t count, std::size_t piece, unsigned threads,
                const std::function<void(std::size_t, std::size_t)> &work) {
  std::atomic<std::size_t> next{0};
  std::mutex lock;
  std::exception_ptr failure;
  const auto take = [&] {
    try {
      for (std::size_t first; (first = next.fetch_add(piece)) < count;) work(first, std::min(first + piece, count));
    } catch (...) {
      next = count;
      const std::lock_guard<std::mutex> guard(lock);
      if (!failure) failure = std::current_exception();
    }
  };
  const std::size_t useful = std::min<std::size_t>(threads, (count + piece - 1) / std::max<std::size_t>(piece, 1));
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < useful; ++i) others.emplace_back(take);
  take();
  for (std::thread &thread : others) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace greenray
