#include "render/sky_rows_run.hpp"

#include <algorithm>

#include "support/error.hpp"

namespace greenray {
namespace {

constexpr int strips_a_worker = 4;  // at least, so that none waits long for another

/// What a worker sends of its strip: to worker 0 the rows, to others whether it failed.
struct Strip {
  int code = 0;
  std::string words;
  TraceStats rays;
  SkyRows rows;

  std::string pack(bool with_rows) const {
    Packer to;
    to.add(code), to.add(words), to.add(with_rows);
    if (with_rows) to.add(rays), to.add(rows.first), to.add(rows.samples), to.add(rows.radiance), to.add(rows.moments);
    return to.take();
  }
  static Strip unpack(const std::string &bytes) {
    Strip s;
    Unpacker from(bytes);
    from.take(s.code), from.take(s.words);
    if (!from.get<bool>()) return s;
    from.take(s.rays), from.take(s.rows.first), from.take(s.rows.samples), from.take(s.rows.radiance),
        from.take(s.rows.moments);
    return s;
  }
};

class SharedRows {
 public:
  SharedRows(Ranks &ranks, SkyRun &run, SkyPicture &picture, int rows_a_band,
             const std::function<void(int, int, SkyRun &)> &shade)
      : ranks_(ranks),
        run_(run),
        picture_(picture),
        shade_(shade),
        strip_(std::clamp((picture.height() + strips_a_worker * ranks.size() - 1) / (strips_a_worker * ranks.size()), 1,
                          rows_a_band)) {}

  void run_all() {
    // Devices differ in what they have room for: the smallest strip serves all, and what is done is worker 0's.
    Packer to;
    to.add(strip_), to.add(run_.done_rows());
    int done = 0;
    const std::vector<std::string> all =
        ranks_.exchange(std::vector<std::string>(static_cast<std::size_t>(ranks_.size()), to.take()));
    for (std::size_t r = 0; r < all.size(); ++r) {
      Unpacker from(all[r]);
      strip_ = std::min(strip_, from.get<int>());
      if (r == 0) done = from.get<int>();
    }
    for (; done < picture_.height(); done = std::min(done + strip_ * ranks_.size(), picture_.height())) turn(done);
    ranks_.part();
  }

 private:
  void turn(int done) {
    const int first = std::min(done + strip_ * ranks_.rank(), picture_.height()),
              last = std::min(first + strip_, picture_.height());
    Strip own;
    const TraceStats before = run_.rays();
    std::exception_ptr own_error;
    try {
      if (first < last) shade_(first, last, run_);
      own.rows = picture_.rows(first, last), own.rays = run_.rays().since(before);
    } catch (const Error &error) {
      own_error = std::current_exception();
      own.code = static_cast<int>(error.exit_code()), own.words = error.what();
    }
    std::vector<std::string> out(static_cast<std::size_t>(ranks_.size()), own.pack(false));
    if (own.code == 0) out.front() = own.pack(true);
    const std::vector<std::string> in = ranks_.exchange(std::move(out));
    for (std::size_t r = 0; r < in.size(); ++r) {
      const Strip strip = Strip::unpack(in[r]);
      if (strip.code != 0) stop(strip, static_cast<int>(r), own_error);
      if (!ranks_.first()) continue;
      if (r > 0 && !picture_.set_rows(strip.rows)) throw RunError("a worker sent rows of another picture");
      if (r > 0) run_.add_rays(strip.rays);
      run_.band_done(std::min(done + strip_ * (static_cast<int>(r) + 1), picture_.height()));
    }
  }

  [[noreturn]] void stop(const Strip &failed, int rank, const std::exception_ptr &own_error) {
    ranks_.part();
    const auto code = static_cast<ExitCode>(failed.code);
    if (!ranks_.first()) throw RanksLost(code);
    if (own_error) run_.keep_after(own_error);
    run_.keep_after(std::make_exception_ptr(Error(code, "worker " + std::to_string(rank) + ": " + failed.words)));
  }

  Ranks &ranks_;
  SkyRun &run_;
  SkyPicture &picture_;
  const std::function<void(int, int, SkyRun &)> &shade_;
  int strip_;
};

void run_alone(SkyRun &run, int rows_a_band, const std::function<void(int, int, SkyRun &)> &shade) {
  try {
    while (run.done_rows() < run.last_row()) {
      const int first = run.done_rows(), last = std::min(first + rows_a_band, run.last_row());
      shade(first, last, run);
      run.band_done(last);
    }
  } catch (const Error &) {
    run.keep_after(std::current_exception());
  }
}

}  // namespace

void run_rows(Ranks &ranks, bool adaptive, SkyRun &run, SkyPicture &picture, int rows_a_band,
              const std::function<void(int, int, SkyRun &)> &shade) {
  if (ranks.size() > 1 && !adaptive) return SharedRows(ranks, run, picture, rows_a_band, shade).run_all();
  ranks.part();
  if (ranks.first()) run_alone(run, rows_a_band, shade);
}

}  // namespace greenray
