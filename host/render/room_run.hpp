// The passes of a room, one after the other or shared out to workers that have a device each, until the picture is
// done.
#pragma once
#include <chrono>
#include <exception>

#include "render/room_checkpoint.hpp"
#include "render/room_picture.hpp"
#include "support/ranks.hpp"

namespace greenray {

/* Workers take passes in turn: of a round of n, worker r makes pass first + r. Each keeps the sums of its share of the
   pixels and is sent that part of every pass, so that sums are made in the order of the passes whoever made them, and
   what a worker sends and takes is one picture a round however many there are. Where the error or the time decides
   when it is enough, worker 0 keeps all the sums, to decide after each pass as one worker alone does. */
class RoomRun {
 public:
  RoomRun(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device, Ranks &ranks);
  /// At worker 0; elsewhere an empty picture.
  RoomPicture render();

 private:
  struct Letter;
  void take_up();
  void share_state();
  void round();
  MadePass make_own(int pass, Letter &letter);
  std::vector<Letter> exchange(Letter own, MadePass made);
  void accept(const Letter &letter);
  void tell_how_it_goes_on(bool &keeps);
  [[noreturn]] void keep_after(const Letter &failed);
  void keep_if_possible();
  void keep();
  std::optional<BlockedTally> gathered();
  std::size_t share_begin(int rank) const;
  bool done() const;
  bool done_by_error_or_time() const;
  double fraction(double part) const;
  double spent_seconds() const;
  void say(const std::string &words) const;
  bool keeps() const { return !options_.checkpoint.empty(); }
  PictureIdentity identity() const { return room_identity(scene_, options_, maker_ ? maker_->plan() : plan_, lanes_); }
  const RoomPlan &plan() const { return maker_->plan(); }

  using Clock = std::chrono::steady_clock;
  const RoomScene &scene_;
  const RoomOptions &options_;
  std::shared_ptr<Device> device_;
  Ranks &ranks_;
  Clock::time_point begin_, last_kept_;
  RoomPlan plan_;
  std::string lanes_;
  std::optional<RoomState> found_;  // in a checkpoint
  std::optional<RoomMaker> maker_;
  RoomBeginning beginning_;            // with the lamps of the passes that are done
  std::optional<BlockedTally> tally_;  // of this worker's share of the pixels
  PixelStatistics::Totals totals_;     // so far, where all pixels are here
  int done_passes_ = 0, resumed_at_ = 0;
  double seconds_before_ = 0, round_seconds_ = 0, keep_seconds_ = 0;
  bool enough_ = false;
  std::exception_ptr own_failure_;
};

}  // namespace greenray
