// Work on all cores of the host: pieces of a range, taken as threads get free.
#pragma once
#include <cstddef>
#include <functional>

namespace greenray {

/// Threads that the host runs at once; at least 1.
unsigned host_threads();

/* Calls work(first, last) for the pieces of 0..count, on up to `threads` threads, in any order.
   errors: the first exception of a piece is thrown again here; pieces not begun by then are left out */
void for_pieces(std::size_t count, std::size_t piece, unsigned threads,
                const std::function<void(std::size_t first, std::size_t last)> &work);

}  // namespace greenray
