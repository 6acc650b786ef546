#include "render/room_share.hpp"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "render/report.hpp"
#include "render/room_checkpoint.hpp"
#include "render/room_looks.hpp"
#include "render/room_picture.hpp"
#include "scene/room_frame.hpp"
#include "support/checked_file.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

constexpr double work_over_keeping = 20;
constexpr std::size_t most_pending_bytes = std::size_t{256} << 20;

/// Of a report what no sum over passes tells.
Json known_json(const RoomReport &r) {
  return {{"triangles", r.triangles},
          {"spheres", r.spheres},
          {"air_cells", r.air_cells},
          {"table_error_m", r.table_error_m},
          {"table_arcsec", r.table_arcsec},
          {"solver_arcsec", r.solver_arcsec},
          {"aimed_cells", r.aimed_cells},
          {"build_seconds", r.build_seconds},
          {"map_seconds", r.map_seconds},
          {"gather_seconds", r.gather_seconds},
          {"cover_seconds", r.cover_seconds},
          {"eye_seconds", r.eye_seconds},
          {"compile_seconds", r.compile_seconds}};
}

/// Numbers of the first share, seconds of all.
void add_known(const Json &j, bool first, RoomReport &r) {
  if (first) {
    r.triangles = j.at("triangles"), r.spheres = j.at("spheres"), r.air_cells = j.at("air_cells");
    r.table_error_m = j.at("table_error_m"), r.table_arcsec = j.at("table_arcsec");
    r.solver_arcsec = j.at("solver_arcsec"), r.aimed_cells = j.at("aimed_cells");
  }
  for (const auto &[name, value] :
       std::initializer_list<std::pair<const char *, double *>>{{"build_seconds", &r.build_seconds},
                                                                {"map_seconds", &r.map_seconds},
                                                                {"gather_seconds", &r.gather_seconds},
                                                                {"cover_seconds", &r.cover_seconds},
                                                                {"eye_seconds", &r.eye_seconds},
                                                                {"compile_seconds", &r.compile_seconds}})
    *value += j.at(name).get<double>();
}

/// What a part of a room has before its blocks.
struct RoomPart {
  PartHead head;
  std::size_t pixels = 0, waves = 0;
  std::int64_t photons_a_pass = 0;
  int blocks = 0, lamp_passes = 0;  // blocks: there now
  std::array<std::size_t, 3> counts{};
  RoomBeginning beginning;

  std::string more() const {
    return Json{{"pixels", pixels},
                {"waves", waves},
                {"blocks", blocks},
                {"lamp_passes", lamp_passes},
                {"photons_a_pass", photons_a_pass},
                {"counts", beginning.counts()}}
        .dump();
  }
};

class RoomPartReader {
 public:
  explicit RoomPartReader(const fs::path &path)
      : reader_(path, part_kind, "a part of a picture made by this version with --shard", "") {
    try {
      std::string more;
      part.head = parse_head(reader_.json(), more);
      const Json j = Json::parse(more);
      part.pixels = j.at("pixels"), part.waves = j.at("waves"), part.blocks = j.at("blocks");
      part.lamp_passes = j.at("lamp_passes"), part.photons_a_pass = j.at("photons_a_pass");
      part.beginning.read(reader_, j.at("counts").get<std::array<std::size_t, 3>>());
    } catch (const Json::exception &) {
      reader_.fail();
    }
    const std::uintmax_t left = reader_.left();
    if (part.waves == 0 || part.waves > (1u << 20) ||
        (part.blocks > 0 && part.pixels > left / (part.waves + 5) / sizeof(double)))
      reader_.fail();
  }
  void next(RoomTally &block) {
    try {
      block.read(reader_);
    } catch (const RunError &) {
      reader_.fail();
    }
  }
  void end() { reader_.end(); }
  [[noreturn]] void fail() const { reader_.fail(); }

  RoomPart part;

 private:
  CheckedReader reader_;
};

class ShareRun {
 public:
  ShareRun(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device,
           const PictureShare &share, const PartHead &head)
      : scene_(scene), options_(options), device_(device), share_(share), begin_(Clock::now()) {
    part_.head = head;
    part_.head.kind = "room", part_.head.share = share;
    part_.head.device_json = device_json(*device).dump();
  }

  RoomReport run() {
    const RoomPlan plan = plan_room(scene_, options_);
    if (plan.open)
      throw InputError({"command line", 1, 1}, "a share of passes without number: expected --photons or --spp");
    part_.head.identity = room_identity(scene_, options_, plan, std::to_string(device_->lanes().lanes_float));
    if (take_up()) return report_;
    maker_.emplace(scene_, options_, device_, plan);
    if (part_.photons_a_pass > 0) maker_->begin(part_.beginning, part_.lamp_passes);
    else maker_->begin();
    part_.pixels = maker_->plan().pixels(), part_.waves = maker_->looks().waves();
    last_kept_ = Clock::now();
    make_all();
    part_.head.complete = true;
    keep();
    return report_;
  }

 private:
  /// returns: is there nothing left to do?
  bool take_up() {
    if (options_.resume == RoomOptions::Resume::never) return false;
    const bool must = options_.resume == RoomOptions::Resume::always;
    const SourcePlace place{options_.checkpoint.string(), 1, 1};
    std::error_code error;
    if (!fs::exists(options_.checkpoint, error)) {
      if (must) throw InputError(place, "expected a part of this share to resume, found none");
      return false;
    }
    try {
      (void)read_part_head(options_.checkpoint);  // is it whole?
      RoomPartReader reader(options_.checkpoint);
      std::vector<std::string> changed = changed_keys(reader.part.head.identity, part_.head.identity);
      if (reader.part.head.share != share_) changed.push_back("--shard was " + reader.part.head.share.words());
      std::vector<Diagnostic> all;
      for (const std::string &key : changed)
        all.push_back({place, "expected a part of this picture: " + key + "; --no-resume starts anew"});
      if (!all.empty()) throw InputError(all);
      const PartHead now = part_.head;
      part_ = std::move(reader.part);
      kept_blocks_ = part_.blocks;
      part_.head.command = now.command;
      add_known(Json::parse(part_.head.report_json), true, before_);
      report_ = before_, report_.resumed_at = kept_blocks_;
      return part_.head.complete;
    } catch (const InputError &wrong) {
      if (must) throw;
      if (options_.note) options_.note(std::string("starting anew: ") + wrong.what());
      return false;
    }
  }

  void make_all() {
    const RoomPlan &plan = maker_->plan();
    const int own = (plan.blocks() - share_.index + share_.count - 1) / share_.count;
    if (own <= 0) {
      if (options_.note)
        options_.note("the picture has " + std::to_string(plan.blocks()) + " blocks of passes: nothing for share " +
                      share_.words());
      part_.photons_a_pass = plan.photons_a_pass;
      part_.beginning.photons_a_pass = plan.photons_a_pass;
      return;
    }
    for (int i = kept_blocks_; i < own; ++i) {
      const int block = share_.index + i * share_.count;
      make_block(block * plan.block_passes(), std::min((block + 1) * plan.block_passes(), plan.passes),
                 static_cast<double>(i) / own, 1.0 / own);
      if (is_time_to_keep()) keep_if_possible();
    }
  }

  void make_block(int first, int last, double before, double share) {
    RoomTally block(part_.pixels, part_.waves);
    const auto make = [&](int pass, double behind) {
      const double each = share / (last - first);
      return maker_->make(pass, [&](const char *phase, double part) {
        if (options_.progress) options_.progress(phase, before + each * (behind + part), 0);
      });
    };
    try {
      if (part_.photons_a_pass == 0 && first > 0) {
        (void)make(0, 0);
        remember_beginning();
      }
      for (int pass = first; pass < last; ++pass) {
        const MadePass made = make(pass, pass - first);
        block.add(made.pass, made.photons);
        if (pass == 0) remember_beginning();
      }
    } catch (const Error &error) {
      keep_after(error);
    }
    part_.beginning.lamp_pixels = maker_->eye().lamp_pixels(), part_.lamp_passes = last;
    pending_.push_back(std::move(block));
  }

  void remember_beginning() {
    part_.beginning = maker_->beginning();
    part_.photons_a_pass = part_.beginning.photons_a_pass;
    part_.lamp_passes = 1;
  }

  bool is_time_to_keep() const {
    if (pending_.size() * pending_.front().bytes() >= most_pending_bytes) return true;
    return seconds_since(last_kept_) >= std::max(options_.checkpoint_seconds, work_over_keeping * keep_seconds_);
  }

  [[noreturn]] void keep_after(const Error &error) {
    const bool interrupted = error.exit_code() == ExitCode::interrupted;
    if (pending_.empty() && kept_blocks_ == 0) throw;
    try {
      if (!pending_.empty()) keep();
    } catch (const Error &second) {
      if (interrupted) throw Interrupted(std::string("interrupted; no checkpoint: ") + second.what());
      throw error;
    }
    const std::string kept = std::to_string(kept_blocks_) + " blocks of passes kept in " + options_.checkpoint.string();
    if (interrupted) throw Interrupted("interrupted: " + kept);
    throw Error(ExitCode::stopped_early, std::string(error.what()) + "; " + kept);
  }

  void keep_if_possible() {
    try {
      keep();
    } catch (const RunError &error) {
      if (pending_.size() * pending_.front().bytes() >= most_pending_bytes) throw;
      if (options_.note) options_.note(std::string("no checkpoint: ") + error.what());
      last_kept_ = Clock::now();
    }
  }

  /// The part anew, with the blocks of the old one copied and the pending ones behind them.
  void keep() {
    const auto begin = Clock::now();
    report_ = before_;
    maker_->describe(report_);
    report_.build_seconds += before_.build_seconds, report_.map_seconds += before_.map_seconds;
    report_.gather_seconds += before_.gather_seconds, report_.cover_seconds += before_.cover_seconds;
    report_.eye_seconds += before_.eye_seconds, report_.compile_seconds += before_.compile_seconds;
    report_.resumed_at = before_.resumed_at;
    part_.head.report_json = known_json(report_).dump();
    part_.blocks = kept_blocks_ + static_cast<int>(pending_.size());
    AtomicFile file(options_.checkpoint);
    CheckedWriter writer(file, part_kind, head_json(part_.head, part_.more()));
    part_.beginning.write(writer);
    if (kept_blocks_ > 0) {
      RoomPartReader old(options_.checkpoint);
      RoomTally block(part_.pixels, part_.waves);
      for (int i = 0; i < kept_blocks_; ++i) old.next(block), block.write(writer);
    }
    for (const RoomTally &block : pending_) block.write(writer);
    writer.end();
    file.commit();
    kept_blocks_ = part_.blocks;
    pending_.clear();
    last_kept_ = Clock::now();
    keep_seconds_ = seconds_since(begin);
  }

  const RoomScene &scene_;
  const RoomOptions &options_;
  std::shared_ptr<Device> device_;
  PictureShare share_;
  Clock::time_point begin_, last_kept_;
  RoomPart part_;
  RoomReport before_, report_;  // before_: of earlier sessions
  std::optional<RoomMaker> maker_;
  int kept_blocks_ = 0;
  std::vector<RoomTally> pending_;  // blocks made since the part was written
  double keep_seconds_ = 0;
};

}  // namespace

RoomReport render_room_share(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device,
                             const PictureShare &share, const PartHead &head) {
  return ShareRun(scene, options, device, share, head).run();
}

namespace {

/// The plan that all parts were made by.
RoomPlan plan_of_parts(const RoomScene &scene, const RoomOptions &options, const std::vector<fs::path> &paths,
                       const std::vector<std::unique_ptr<RoomPartReader>> &readers,
                       const std::vector<std::size_t> &order) {
  RoomPlan plan = plan_room(scene, options);
  const RoomPart &first = readers[order[0]]->part;
  std::vector<std::string> changed =
      changed_keys(first.head.identity, room_identity(scene, options, plan, first.head.identity.options.at("--lanes")));
  std::vector<Diagnostic> wrong;
  for (const std::string &key : changed)
    wrong.push_back({{paths[order[0]].string(), 1, 1}, "expected a part of the scene as it is now: " + key});
  for (const std::size_t i : order)
    if (readers[i]->part.photons_a_pass != first.photons_a_pass)
      wrong.push_back({{paths[i].string(), 1, 1},
                       "expected passes of " + std::to_string(first.photons_a_pass) + " photons, found " +
                           std::to_string(readers[i]->part.photons_a_pass) + ": give all shares the same --mem"});
  if (!wrong.empty()) throw InputError(wrong);
  fit_passes(plan, first.photons_a_pass, scene, options, {paths[order[0]].string(), 1, 1});
  for (std::size_t s = 0; s < order.size(); ++s) {
    const RoomPart &part = readers[order[s]]->part;
    const int count = static_cast<int>(order.size());
    const int own = std::max(0, (plan.blocks() - static_cast<int>(s) + count - 1) / count);
    if (part.blocks != own || (own > 0 && part.pixels != plan.pixels())) readers[order[s]]->fail();
  }
  return plan;
}

}  // namespace

MergedRoom merge_room(const RoomScene &scene, const RoomOptions &options, const std::vector<fs::path> &paths) {
  std::vector<PartHead> heads;
  for (const fs::path &path : paths) heads.push_back(read_part_head(path));
  const std::vector<std::size_t> order = order_of_parts(paths, heads);
  std::vector<std::unique_ptr<RoomPartReader>> readers;
  for (const fs::path &path : paths) readers.push_back(std::make_unique<RoomPartReader>(path));
  const RoomPlan plan = plan_of_parts(scene, options, paths, readers, order);
  const std::vector<double> wavelength_nm = room_looks(moved_to_middle(scene)).wavelength_nm;
  RoomTally whole(plan.pixels(), wavelength_nm.size()), block = whole;
  for (int b = 0; b < plan.blocks(); ++b) {
    stop_if_asked();
    readers[order[static_cast<std::size_t>(b) % order.size()]]->next(block);
    whole.add(block);
  }
  RoomReport report;
  std::vector<int> lamps;
  for (const std::size_t i : order) {
    const RoomPart &part = readers[i]->part;
    add_known(Json::parse(part.head.report_json), i == order[0], report);
    std::vector<int> all;
    std::set_union(lamps.begin(), lamps.end(), part.beginning.lamp_pixels.begin(), part.beginning.lamp_pixels.end(),
                   std::back_inserter(all));
    lamps = std::move(all);
  }
  const RoomPart &first = readers[order[0]]->part;
  report.lamp_pixels = lamps.size(), report.edge_pixels = first.beginning.edge_pixels.size();
  report.workers = static_cast<int>(order.size());
  return {picture_of(plan, wavelength_nm, whole, report), first.head.device_json};
}

}  // namespace greenray
