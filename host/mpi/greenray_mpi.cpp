#include "mpi/greenray_mpi.hpp"

#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>
#include <sched.h>
#include <time.h>

#include <algorithm>
#include <cstdint>
#include <memory>

namespace greenray {
namespace {

constexpr std::size_t piece = std::size_t{1} << 28;  // MPI counts with int
constexpr int looks_before_sleep = 200;

void check(int status) {
  if (status != MPI_SUCCESS) throw RanksLost();
}

/// MPI's own waiting turns a core at full speed, which another worker may need: this one sleeps between looks.
void wait_for(std::vector<MPI_Request> &requests) {
  for (int looks = 0;; ++looks) {
    int done = 0;
    check(MPI_Testall(static_cast<int>(requests.size()), requests.data(), &done, MPI_STATUSES_IGNORE));
    if (done) return;
    if (looks < looks_before_sleep) {
      sched_yield();
    } else {
      const timespec a_little{0, looks < 100 * looks_before_sleep ? 50'000 : 500'000};
      nanosleep(&a_little, nullptr);
    }
  }
}

class MpiRanks : public Ranks {
 public:
  MpiRanks() {
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    check(MPI_Comm_rank(MPI_COMM_WORLD, &rank_));
    check(MPI_Comm_size(MPI_COMM_WORLD, &size_));
  }
  int rank() const override { return rank_; }
  int size() const override { return size_; }

  std::vector<std::string> exchange(std::vector<std::string> out) override {
    const auto count = static_cast<std::size_t>(size_);
    std::vector<std::uint64_t> sends(count), comes(count);
    for (std::size_t r = 0; r < count; ++r) sends[r] = out[r].size();
    std::vector<MPI_Request> requests(1);
    check(MPI_Ialltoall(sends.data(), 1, MPI_UINT64_T, comes.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD, &requests[0]));
    wait_for(requests);
    std::vector<std::string> in(count);
    requests.clear();
    for (int step = 1; step < size_; ++step) {  // each begins with its neighbour, so that no one is asked by all
      const int from = (rank_ + size_ - step) % size_;
      std::string &bytes = in[static_cast<std::size_t>(from)];
      bytes.resize(comes[static_cast<std::size_t>(from)]);
      in_pieces(bytes, requests, [&](char *at, int some, MPI_Request *request) {
        return MPI_Irecv(at, some, MPI_BYTE, from, tag, MPI_COMM_WORLD, request);
      });
    }
    for (int step = 1; step < size_; ++step) {
      const int to = (rank_ + step) % size_;
      in_pieces(out[static_cast<std::size_t>(to)], requests, [&](char *at, int some, MPI_Request *request) {
        return MPI_Isend(at, some, MPI_BYTE, to, tag, MPI_COMM_WORLD, request);
      });
    }
    in[static_cast<std::size_t>(rank_)] = std::move(out[static_cast<std::size_t>(rank_)]);
    wait_for(requests);
    return in;
  }

 private:
  template <class Call>
  static void in_pieces(std::string &bytes, std::vector<MPI_Request> &requests, const Call &call) {
    for (std::size_t at = 0; at < bytes.size(); at += piece) {
      requests.push_back(MPI_REQUEST_NULL);
      check(call(bytes.data() + at, static_cast<int>(std::min(piece, bytes.size() - at)), &requests.back()));
    }
  }

  static constexpr int tag = 7;
  int rank_ = 0, size_ = 1;
};

std::unique_ptr<MpiRanks> all;

}  // namespace
}  // namespace greenray

const char *greenray_mpi_version() { return GREENRAY_VERSION; }

greenray::Ranks *greenray_mpi_start() {
  int level = 0;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &level) != MPI_SUCCESS) return nullptr;
  greenray::all = std::make_unique<greenray::MpiRanks>();
  return greenray::all.get();
}

void greenray_mpi_finish() { MPI_Finalize(); }

void greenray_mpi_abort(int code) { MPI_Abort(MPI_COMM_WORLD, code); }
