// The rows of a sky picture that are done, kept in a file, so that a run can be taken up again and shares of it put
// together with the same bits.
#pragma once
#include <chrono>
#include <exception>
#include <filesystem>
#include <optional>

#include "render/picture_part.hpp"
#include "render/renderer.hpp"
#include "render/sky_picture.hpp"
#include "support/ranks.hpp"

namespace greenray {

/// A band of rows whose samples are not all taken.
struct SkyBand {
  int first_row = 0, rows = 0, samples = 0;
  double seconds = 0;                   // spent on it
  std::vector<float> spectra, moments;  // as SkySums
};

/// Where and when a sky picture is kept.
struct SkyKeeping {
  std::filesystem::path file;
  double seconds = 60;     // from one to the next
  double not_before = 10;  // of the whole run: what takes no longer is sooner made anew
  enum class Resume { when_it_fits, always, never } resume = Resume::when_it_fits;
  std::optional<PictureShare> share;  // then the file is that share's part
  std::vector<std::string> command;   // for the part's head
  std::function<void(const std::string &)> note;
};

PictureIdentity sky_identity(const Scene &scene, const RenderPlan &plan, const RenderOptions &options,
                             const std::string &lanes);

/* Rows first_row .. last_row - 1 of the crop are wanted here: all, or a share of them. Those before done_rows are in
   the picture. Every call that ends a band may write the file. */
class SkyRun {
 public:
  /// Looks for the file and fills its rows into the picture. rows_a_band: where each band stops by itself, of noise or
  /// of time, else 0.
  SkyRun(const SkyKeeping *keeping, PictureIdentity identity, int rows_a_band, SkyPicture &picture);

  int last_row() const { return last_; }
  int done_rows() const { return done_; }
  int resumed_rows() const { return resumed_; }   // that were done before
  bool is_complete() const { return complete_; }  // a part that was finished before
  /// The band that was begun, if it is this one.
  std::optional<SkyBand> begun(int first_row, int rows);

  /// Rays that rows had of their own.
  void add_rays(const TraceStats &rays) { rays_.add(rays); }
  const TraceStats &rays() const { return rays_; }
  void band_done(int last_row);
  /// After a pass of a band: how its sums are read, and perhaps kept; nothing while they are not whole.
  void in_band(std::function<SkyBand()> band);
  /// Ends what in_band was told; its sums are kept in mind if that is by an exception.
  class InBand {
   public:
    explicit InBand(SkyRun &run) : run_(run), failures_(std::uncaught_exceptions()) {}
    ~InBand() { run_.leave_band(std::uncaught_exceptions() > failures_); }
    InBand(const InBand &) = delete;
    InBand &operator=(const InBand &) = delete;

   private:
    SkyRun &run_;
    int failures_;
  };
  /// What to throw when `error` stopped it: says what was kept.
  [[noreturn]] void keep_after(const std::exception_ptr &error);
  /// The finished part, with the channels that describe its rows.
  void complete(const std::string &report_json);

 private:
  void take_up();
  void leave_band(bool failed);
  bool is_time() const;
  void keep_if_possible(const std::optional<SkyBand> &band);
  void write(const std::optional<SkyBand> &band);
  double spent_seconds() const;

  using Clock = std::chrono::steady_clock;
  const SkyKeeping *keeping_;
  PartHead head_;
  SkyPicture &picture_;
  Clock::time_point begin_, last_kept_;
  int first_ = 0, last_ = 0, done_ = 0, resumed_ = 0;
  bool complete_ = false;
  double seconds_before_ = 0, keep_seconds_ = 0;
  TraceStats rays_;
  std::optional<SkyBand> begun_, left_;  // left_: by an exception
  std::function<SkyBand()> band_;
};

/// Rows of share `share` of a picture of so many rows.
std::array<int, 2> rows_of_share(int rows, const PictureShare &share);

struct MergedSky {
  SpectralImage image;
  double noise_rms = 0;
  int spp = 0;              // largest
  std::string report_json;  // of the first share
  TraceStats more_rays;     // that the rows of the others had
};

/// Parts of every share, in any order. Needs no device. errors: InputError
MergedSky merge_sky(const Scene &scene, const RenderPlan &plan, const RenderOptions &options,
                    const std::vector<std::filesystem::path> &parts);

}  // namespace greenray
