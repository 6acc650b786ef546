#include "render/room_run.hpp"

#include <algorithm>
#include <cmath>

#include "support/error.hpp"

namespace greenray {
namespace {

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

constexpr int passes_before_stopping = 4;  // the noise from pass to pass is not known from fewer
constexpr double work_over_keeping = 20;   // at least: large pictures are not written all the time

/// "8", or "8,1" of workers with unlike devices: then it matters which of them makes which pass.
std::string lanes_of(Ranks &ranks, const Device &device) {
  const std::string own = std::to_string(device.lanes().lanes_float);
  if (ranks.size() == 1) return own;
  const std::vector<std::string> all =
      ranks.exchange(std::vector<std::string>(static_cast<std::size_t>(ranks.size()), own));
  if (std::all_of(all.begin(), all.end(), [&](const std::string &lanes) { return lanes == all.front(); })) return own;
  std::string list;
  for (const std::string &lanes : all) list += (list.empty() ? "" : ",") + lanes;
  return list;
}

}  // namespace

/// What a worker sends of its pass to each other one.
struct RoomRun::Letter {
  int code = 0, rank = 0;  // code: of an error
  std::string words;
  bool has_pass = false, has_beginning = false;
  PhotonTotals photons;
  std::vector<int> lamp_pixels;
  RoomBeginning beginning;
  RoomPass pass;  // the receiver's share of the pixels

  std::string pack() const {
    Packer to;
    to.add(code), to.add(words), to.add(has_pass), to.add(has_beginning);
    if (has_beginning)
      to.add(
          std::vector<std::size_t>{beginning.radii.size(), beginning.lamp_pixels.size(), beginning.edge_pixels.size()}),
          beginning.write(to);
    if (!has_pass) return to.take();
    to.add(photons), to.add(lamp_pixels);
    for (const std::vector<float> RoomPass::*values : arrays) to.add(pass.*values);
    return to.take();
  }
  static Letter unpack(const std::string &bytes) {
    Letter letter;
    Unpacker from(bytes);
    from.take(letter.code), from.take(letter.words), from.take(letter.has_pass), from.take(letter.has_beginning);
    if (letter.has_beginning) {
      std::vector<std::size_t> counts;
      from.take(counts, 3);
      letter.beginning.read(from, {counts[0], counts[1], counts[2]});
    }
    if (!letter.has_pass) return letter;
    from.take(letter.photons), from.take(letter.lamp_pixels);
    for (std::vector<float> RoomPass::*values : arrays) from.take(letter.pass.*values);
    return letter;
  }
  static constexpr std::array<std::vector<float> RoomPass::*, 6> arrays{&RoomPass::radiance,  &RoomPass::narrower,
                                                                        &RoomPass::variance,  &RoomPass::depth_m,
                                                                        &RoomPass::bend_mrad, &RoomPass::photon_count};
};

RoomRun::RoomRun(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device,
                 Ranks &ranks)
    : scene_(scene),
      options_(options),
      device_(device),
      ranks_(ranks),
      begin_(Clock::now()),
      plan_(plan_room(scene, options)),
      lanes_(lanes_of(ranks, *device)) {}

RoomPicture RoomRun::render() {
  ranks_.together([&] {
    if (ranks_.first()) take_up();
    RoomOptions own = options_;
    if (!ranks_.first()) own.photon_map = 0;
    maker_.emplace(scene_, own, device_, plan_);
  });
  share_state();
  last_kept_ = Clock::now();
  while (!done()) round();
  std::optional<BlockedTally> all = gathered();
  ranks_.part();
  if (!ranks_.first()) return {};
  all->end();
  RoomReport report;
  maker_->describe(report);
  report.resumed_at = resumed_at_, report.workers = ranks_.size();
  report.lamp_pixels = beginning_.lamp_pixels.size(), report.edge_pixels = beginning_.edge_pixels.size();
  RoomPicture picture = picture_of(plan(), maker_->looks().wavelength_nm, all->whole(), report);
  picture.photon_map = maker_->take_photon_map();
  return picture;
}

/// Looks for a checkpoint of this picture.
void RoomRun::take_up() {
  if (!keeps() || options_.resume == RoomOptions::Resume::never) return;
  const bool must = options_.resume == RoomOptions::Resume::always;
  std::optional<RoomCheckpoint> found;
  std::vector<std::string> changed;
  try {
    found = read_checkpoint(options_.checkpoint);
    if (found) changed = changed_keys(found->identity, identity());
  } catch (const InputError &error) {
    if (must) throw;
    return say("the checkpoint " + options_.checkpoint.string() + " is damaged: starting anew");
  }
  const SourcePlace place{options_.checkpoint.string(), 1, 1};
  if (!found && must) throw InputError(place, "expected a checkpoint to resume, found none");
  if (!found) return;
  if (changed.empty()) {
    found_ = std::move(found->state);
    RoomPlan as_then = plan_;
    fit_passes(as_then, found_->beginning.photons_a_pass, scene_, options_, place);
    return;
  }
  std::vector<Diagnostic> all;
  for (const std::string &key : changed)
    all.push_back({place, "expected a checkpoint of this picture: " + key + "; --no-resume starts anew"});
  if (must) throw InputError(all);
  std::string keys;
  for (const std::string &key : changed) keys += (keys.empty() ? "" : "; ") + key;
  say("the checkpoint is of another picture, starting anew: " + keys);
}

/// What worker 0 found goes to all; without it, it makes room for the first pass.
void RoomRun::share_state() {
  Packer to;
  to.add(found_.has_value());
  if (found_) {
    to.add(std::vector<std::size_t>{found_->beginning.radii.size(), found_->beginning.lamp_pixels.size(),
                                    found_->beginning.edge_pixels.size()});
    found_->beginning.write(to);
    to.add(found_->passes), to.add(found_->seconds);
  }
  const std::string letter = ranks_.size() > 1 ? ranks_.from_first(to.take()) : to.take();
  Unpacker from(letter);
  const bool resumes = from.get<bool>();
  if (resumes) {
    std::vector<std::size_t> counts;
    from.take(counts, 3);
    beginning_.read(from, {counts[0], counts[1], counts[2]});
    from.take(done_passes_), from.take(seconds_before_);
    resumed_at_ = done_passes_;
  }
  ranks_.together([&] {
    if (resumes) maker_->begin(beginning_, done_passes_);
    else if (ranks_.first()) maker_->begin();
  });
  if (!resumes) return;
  // The sums, each worker its share of the pixels.
  const std::size_t waves = maker_->looks().waves();
  std::vector<std::string> out(static_cast<std::size_t>(ranks_.size()));
  ranks_.together([&] {
    if (!found_) return;
    if (found_->tally.whole().pixels.pixels() != plan().pixels() || found_->tally.whole().pixels.waves() != waves)
      throw RunError("the checkpoint is of another picture");
    for (int r = 0; r < ranks_.size(); ++r) {
      Packer part;
      found_->tally.part(share_begin(r), share_begin(r + 1)).write(part);
      out[static_cast<std::size_t>(r)] = part.take();
    }
  });
  found_.reset();
  const std::string own = ranks_.size() > 1 ? ranks_.exchange(std::move(out)).front() : std::move(out.front());
  const std::size_t pixels = share_begin(ranks_.rank() + 1) - share_begin(ranks_.rank());
  tally_.emplace(pixels, waves, plan().block_passes());
  Unpacker sums(own);
  tally_->read(sums);
}

/// First pixel of a worker's share.
std::size_t RoomRun::share_begin(int rank) const {
  const std::size_t pixels = plan().pixels();
  if (plan().open) return rank == 0 ? 0 : pixels;
  return pixels * static_cast<std::size_t>(rank) / static_cast<std::size_t>(ranks_.size());
}

void RoomRun::say(const std::string &words) const {
  if (options_.note && ranks_.first()) options_.note(words);
}

double RoomRun::spent_seconds() const { return seconds_before_ + seconds_since(begin_); }

bool RoomRun::done() const { return enough_ || (done_passes_ > 0 && done_passes_ >= plan().passes); }

bool RoomRun::done_by_error_or_time() const {
  if (!plan().open || done_passes_ < passes_before_stopping) return false;
  if (options_.error_pct && 100 * totals_.error_rms() <= *options_.error_pct) return true;
  return options_.minutes && spent_seconds() + 0.5 * round_seconds_ >= 60 * *options_.minutes;
}

/// How much is done, as far as that can be told.
double RoomRun::fraction(double part) const {
  const double behind = done_passes_ + part * ranks_.size();
  double most = std::min(1.0, behind / plan().passes);
  if (!plan().open) return most;
  if (options_.minutes) most = std::max(most, spent_seconds() / (60 * *options_.minutes));
  const double error_pct = 100 * totals_.error_rms();  // falls as passes^(-1/3)
  if (options_.error_pct && error_pct > 0) most = std::max(most, std::pow(*options_.error_pct / error_pct, 3));
  return std::min(most, 0.99);
}

/// The first pass is worker 0's alone: the others need what it finds.
void RoomRun::round() {
  const int width = done_passes_ == 0 ? 1 : ranks_.size(), own = done_passes_ + ranks_.rank();
  const auto begin = Clock::now();
  Letter letter;
  MadePass made;
  if (ranks_.rank() < width && own < plan().passes) made = make_own(own, letter);
  for (const Letter &from : exchange(std::move(letter), std::move(made))) {
    if (from.code != 0) keep_after(from);
    if (from.has_pass && !enough_) accept(from);
  }
  round_seconds_ = seconds_since(begin);
  bool keeps_now = false;
  tell_how_it_goes_on(keeps_now);
  if (keeps_now) keep_if_possible();
}

MadePass RoomRun::make_own(int pass, Letter &letter) {
  MadePass made;
  try {
    made = maker_->make(pass, [&](const char *phase, double part) {
      if (options_.progress && ranks_.first()) options_.progress(phase, fraction(part), totals_.error_rms());
    });
    letter.has_pass = true;
    letter.photons = made.photons;
    letter.lamp_pixels = made.lamp_pixels;
    letter.has_beginning = pass == 0;
    if (pass == 0) letter.beginning = maker_->beginning();
  } catch (const Error &error) {
    own_failure_ = std::current_exception();
    letter.code = static_cast<int>(error.exit_code()), letter.words = error.what();
  }
  return made;
}

std::vector<RoomRun::Letter> RoomRun::exchange(Letter own, MadePass made) {
  std::vector<Letter> letters;
  if (ranks_.size() == 1) {
    own.pass = std::move(made.pass);
    letters.push_back(std::move(own));
    return letters;
  }
  std::vector<std::string> out;
  for (int r = 0; r < ranks_.size(); ++r) {
    if (own.has_pass) own.pass = part_of(made.pass, share_begin(r), share_begin(r + 1), maker_->looks().waves());
    out.push_back(own.pack());
  }
  own = {};
  for (std::string &bytes : ranks_.exchange(std::move(out))) {
    letters.push_back(Letter::unpack(bytes));
    letters.back().rank = static_cast<int>(letters.size()) - 1;
    bytes.clear(), bytes.shrink_to_fit();
  }
  return letters;
}

void RoomRun::accept(const Letter &letter) {
  if (letter.has_beginning) {
    beginning_ = letter.beginning;
    if (!ranks_.first()) maker_->begin(beginning_, 1);
  }
  if (!tally_)
    tally_.emplace(share_begin(ranks_.rank() + 1) - share_begin(ranks_.rank()), maker_->looks().waves(),
                   plan().block_passes());
  tally_->add(letter.pass, letter.photons);
  ++done_passes_;
  maker_->eye().add_lamp_pixels(letter.lamp_pixels, done_passes_);
  beginning_.lamp_pixels = letter.lamp_pixels;
  if (ranks_.first() && (ranks_.size() == 1 || plan().open)) {
    totals_ = totals_of(plan(), tally_->whole().pixels);
    enough_ = done_by_error_or_time();
  }
}

/// Worker 0's clock and errors decide for all.
void RoomRun::tell_how_it_goes_on(bool &keeps_now) {
  const double apart = std::max(options_.checkpoint_seconds, work_over_keeping * keep_seconds_);
  keeps_now = keeps() && seconds_since(last_kept_) >= apart && !done();
  if (ranks_.size() == 1) return;
  Packer to;
  to.add(enough_), to.add(done_passes_), to.add(keeps_now);
  const std::string letter = ranks_.from_first(to.take());
  Unpacker from(letter);
  from.take(enough_), from.take(done_passes_), from.take(keeps_now);
}

/// All pixels at worker 0, nothing elsewhere.
std::optional<BlockedTally> RoomRun::gathered() {
  if (ranks_.size() == 1) return tally_;
  Packer to;
  tally_->write(to);
  const std::vector<std::string> parts = ranks_.at_first(to.take());
  if (!ranks_.first()) return std::nullopt;
  const std::size_t waves = maker_->looks().waves();
  std::optional<BlockedTally> all(std::in_place, plan().pixels(), waves, plan().block_passes());
  for (int r = ranks_.size() - 1; r >= 0; --r) {
    BlockedTally part(share_begin(r + 1) - share_begin(r), waves, plan().block_passes());
    Unpacker from(parts[static_cast<std::size_t>(r)]);
    part.read(from);
    all->place(part, share_begin(r));
  }
  return all;
}

/// An interrupted or failed pass leaves those before it.
void RoomRun::keep_after(const Letter &failed) {
  const auto code = static_cast<ExitCode>(failed.code);
  const bool interrupted = code == ExitCode::interrupted;
  const bool can_keep = keeps() && done_passes_ > 0;
  std::string no_checkpoint;
  if (can_keep) {
    try {
      keep();
    } catch (const RanksLost &) {
      throw;
    } catch (const Error &second) {
      no_checkpoint = second.what();
    }
  }
  ranks_.part();
  if (!ranks_.first()) throw RanksLost(code);
  if (!can_keep || (!no_checkpoint.empty() && !interrupted)) {
    if (own_failure_) std::rethrow_exception(own_failure_);
    throw Error(code, "worker " + std::to_string(failed.rank) + ": " + failed.words);
  }
  if (!no_checkpoint.empty()) throw Interrupted("interrupted; no checkpoint: " + no_checkpoint);
  const std::string kept =
      "checkpoint of " + std::to_string(done_passes_) + " passes kept in " + options_.checkpoint.string();
  if (interrupted) throw Interrupted("interrupted: " + kept);
  throw Error(ExitCode::stopped_early, failed.words + "; " + kept);
}

/// A full disk must not end a render that may still fit its picture.
void RoomRun::keep_if_possible() {
  try {
    keep();
  } catch (const RunError &error) {
    say(std::string("no checkpoint: ") + error.what());
    last_kept_ = Clock::now();
  }
}

void RoomRun::keep() {
  const auto begin = Clock::now();
  std::optional<BlockedTally> all = gathered();
  if (ranks_.first())
    write_checkpoint(options_.checkpoint,
                     {identity(), RoomState{done_passes_, beginning_, std::move(*all), spent_seconds()}});
  last_kept_ = Clock::now();
  keep_seconds_ = seconds_since(begin);
}

}  // namespace greenray
