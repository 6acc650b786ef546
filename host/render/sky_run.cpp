#include "render/sky_run.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "scene/scene_file.hpp"
#include "support/checked_file.hpp"
#include "support/error.hpp"
#include "support/toml_reader.hpp"
#include "support/version.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const std::string checkpoint_kind = "greenray sky checkpoint 1";
constexpr double work_over_keeping = 20;  // large pictures are not written all the time

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// What a file holds behind its head.
struct SkyFile {
  PartHead head;
  int first = 0, last = 0, done = 0;
  double seconds = 0;
  TraceStats rays;  // of these rows
  SkyRows rows;     // first .. done - 1
  std::vector<std::string> channels;
  std::vector<std::vector<float>> channel_rows;
  std::optional<SkyBand> band;

  void write(const fs::path &path, const std::string &kind) const {
    Json more{{"first", first},
              {"last", last},
              {"done", done},
              {"seconds", seconds},
              {"rays",
               {rays.outcomes, rays.rays, rays.steps, rays.rejected, rays.device_seconds, rays.solver_error_rad,
                rays.bouguer_drift}},
              {"counts", {rows.samples.size(), rows.radiance.size(), rows.moments.size()}},
              {"channels", channels}};
    if (band)
      more["band"] = {{"first_row", band->first_row},
                      {"rows", band->rows},
                      {"samples", band->samples},
                      {"seconds", band->seconds},
                      {"counts", {band->spectra.size(), band->moments.size()}}};
    AtomicFile file(path);
    CheckedWriter writer(file, kind, head_json(head, more.dump()));
    writer.add(rows.samples), writer.add(rows.radiance), writer.add(rows.moments);
    for (const std::vector<float> &values : channel_rows) writer.add(values);
    if (band) writer.add(band->spectra), writer.add(band->moments);
    writer.end();
    file.commit();
  }

  static SkyFile read(const fs::path &path, const std::string &kind, const std::string &else_do) {
    CheckedReader reader(
        path, kind,
        kind == part_kind ? "a part of a picture made by this version with --shard" : "a checkpoint of this version",
        else_do);
    SkyFile f;
    try {
      std::string words;
      f.head = parse_head(reader.json(), words);
      const Json more = Json::parse(words);
      f.first = more.at("first"), f.last = more.at("last"), f.done = more.at("done");
      f.seconds = more.at("seconds");
      const Json &r = more.at("rays");
      f.rays = {r.at(0), r.at(1), r.at(2), r.at(3), r.at(4), r.at(5), r.at(6)};
      f.rows.first = f.first;
      const std::vector<std::size_t> counts = more.at("counts");
      reader.take(f.rows.samples, counts.at(0)), reader.take(f.rows.radiance, counts.at(1));
      reader.take(f.rows.moments, counts.at(2));
      f.channels = more.at("channels").get<std::vector<std::string>>();
      f.channel_rows.resize(f.channels.size());
      for (std::vector<float> &values : f.channel_rows) reader.take(values, counts.at(2) / 2);
      if (more.contains("band")) {
        const Json &b = more.at("band");
        f.band = SkyBand{b.at("first_row"), b.at("rows"), b.at("samples"), b.at("seconds"), {}, {}};
        reader.take(f.band->spectra, b.at("counts").at(0)), reader.take(f.band->moments, b.at("counts").at(1));
      }
    } catch (const Json::exception &) {
      reader.fail();
    } catch (const std::out_of_range &) {
      reader.fail();
    }
    reader.end();
    if (f.first < 0 || f.done < f.first || f.last < f.done ||
        f.rows.samples.size() != static_cast<std::size_t>(f.done - f.first))
      reader.fail();
    return f;
  }
};

std::string words(const std::array<int, 4> &crop) {
  std::string text;
  for (const int x : crop) text += (text.empty() ? "" : ",") + std::to_string(x);
  return text;
}

}  // namespace

PictureIdentity sky_identity(const Scene &scene, const RenderPlan &plan, const RenderOptions &options,
                             const std::string &lanes) {
  const auto number = [](const auto &value) { return value ? std::to_string(*value) : std::string("not given"); };
  TomlDocument document(scene.file, scene.text);
  for (const std::string &assignment : scene.overrides) document.override_with(assignment);
  return {scene_hash(scene),
          document.values(),
          {{"version", version()},
           {"--seed", std::to_string(options.seed)},
           {"--lanes", lanes},
           {"--straight", options.straight ? "yes" : "no"},
           {"--size", std::to_string(plan.size[0]) + "x" + std::to_string(plan.size[1])},
           {"--crop", words(plan.crop)},
           {"--spp", std::to_string(plan.spp)},
           {"--error", number(plan.error_pct)},
           {"--minutes", plan.minutes ? "given" : "not given"}}};
}

std::array<int, 2> rows_of_share(int rows, const PictureShare &share) {
  const auto at = [&](int i) { return static_cast<int>(std::int64_t{rows} * i / share.count); };
  return {at(share.index), at(share.index + 1)};
}

SkyRun::SkyRun(const SkyKeeping *keeping, PictureIdentity identity, int rows_a_band, SkyPicture &picture)
    : keeping_(keeping), picture_(picture), begin_(Clock::now()), last_kept_(begin_), last_(picture.height()) {
  head_.kind = "sky", head_.identity = std::move(identity);
  head_.identity.options["rows that stop by themselves"] = std::to_string(rows_a_band);
  head_.device_json = head_.report_json = "{}";
  if (!keeping_) return;
  head_.command = keeping_->command;
  if (keeping_->share) {
    head_.share = *keeping_->share;
    const auto [from, to] = rows_of_share(last_, head_.share);
    first_ = from, last_ = to;
  }
  done_ = first_;
  take_up();
}

double SkyRun::spent_seconds() const { return seconds_before_ + seconds_since(begin_); }

void SkyRun::take_up() {
  using Resume = SkyKeeping::Resume;
  std::error_code error;
  if (keeping_->resume == Resume::never) return;
  const bool must = keeping_->resume == Resume::always;
  const SourcePlace place{keeping_->file.string(), 1, 1};
  if (!fs::exists(keeping_->file, error)) {
    if (must) throw InputError(place, "expected a checkpoint to resume, found none");
    return;
  }
  try {
    SkyFile found =
        SkyFile::read(keeping_->file, keeping_->share ? part_kind : checkpoint_kind, "--no-resume starts anew");
    std::vector<std::string> changed = changed_keys(found.head.identity, head_.identity);
    if (found.head.share != head_.share) changed.push_back("--shard was " + found.head.share.words());
    std::vector<Diagnostic> all;
    for (const std::string &key : changed)
      all.push_back({place, "expected a checkpoint of this picture: " + key + "; --no-resume starts anew"});
    if (all.empty() && (found.first != first_ || found.last != last_ || !picture_.set_rows(found.rows)))
      all.push_back({place, "expected a checkpoint of this picture: its size is another; --no-resume starts anew"});
    if (!all.empty()) throw InputError(all);
    done_ = found.done, resumed_ = done_ - first_, seconds_before_ = found.seconds;
    complete_ = found.head.complete, rays_ = found.rays;
    begun_ = std::move(found.band);
  } catch (const InputError &wrong) {
    if (must) throw;
    if (keeping_->note) keeping_->note(std::string("starting anew: ") + wrong.what());
  }
}

std::optional<SkyBand> SkyRun::begun(int first_row, int rows) {
  std::optional<SkyBand> band = std::move(begun_);
  begun_.reset();
  if (band && (band->first_row != first_row || band->rows != rows)) band.reset();
  return band;
}

bool SkyRun::is_time() const {
  return keeping_ && spent_seconds() >= keeping_->not_before &&
         seconds_since(last_kept_) >= std::max(keeping_->seconds, work_over_keeping * keep_seconds_);
}

void SkyRun::band_done(int last_row) {
  done_ = last_row;
  if (done_ < last_ && is_time()) keep_if_possible({});
}

void SkyRun::in_band(std::function<SkyBand()> band) {
  band_ = std::move(band);
  if (band_ && is_time()) keep_if_possible(band_());
}

void SkyRun::leave_band(bool failed) {
  if (failed && band_ && keeping_ && spent_seconds() >= keeping_->not_before) {
    try {
      left_ = band_();
    } catch (const std::exception &) {  // the device is gone, or no room: the band is made again
    }
  }
  band_ = nullptr;
}

/// A full disk must not end a render that may still fit its picture.
void SkyRun::keep_if_possible(const std::optional<SkyBand> &band) {
  try {
    write(band);
  } catch (const RunError &error) {
    if (keeping_->note) keeping_->note(std::string("no checkpoint: ") + error.what());
    last_kept_ = Clock::now();
  }
}

void SkyRun::write(const std::optional<SkyBand> &band) {
  const auto begin = Clock::now();
  SkyFile f{head_, first_, last_, done_, spent_seconds(), rays_, picture_.rows(first_, done_), {}, {}, band};
  if (head_.complete)
    for (const auto &[name, values] : picture_.image().channels) {
      if (name == "variance") continue;  // follows from the rest
      const auto at = [&](int row) { return values.begin() + static_cast<std::ptrdiff_t>(row) * picture_.width(); };
      f.channels.push_back(name);
      f.channel_rows.emplace_back(at(first_), at(done_));
    }
  f.write(keeping_->file, keeping_->share ? part_kind : checkpoint_kind);
  last_kept_ = Clock::now();
  keep_seconds_ = seconds_since(begin);
}

void SkyRun::keep_after(const std::exception_ptr &error) {
  try {
    std::rethrow_exception(error);
  } catch (const RanksLost &) {
    throw;
  } catch (const Error &stopped) {
    const bool interrupted = stopped.exit_code() == ExitCode::interrupted;
    if (!keeping_ || spent_seconds() < keeping_->not_before) throw;
    const std::optional<SkyBand> begun = std::move(left_);
    try {
      if (done_ == first_ && !begun) throw;
      write(begun);
    } catch (const Error &second) {
      if (interrupted && done_ > first_) throw Interrupted(std::string("interrupted; no checkpoint: ") + second.what());
      std::rethrow_exception(error);
    }
    const std::string kept = "checkpoint of " + std::to_string(done_ - first_) + " rows" +
                             (begun ? " and " + std::to_string(begun->samples) + " samples of the next" : "") +
                             " kept in " + keeping_->file.string();
    if (interrupted) throw Interrupted("interrupted: " + kept);
    throw Error(ExitCode::stopped_early, std::string(stopped.what()) + "; " + kept);
  }
}

void SkyRun::complete(const std::string &report_json) {
  head_.complete = true;
  head_.report_json = report_json;
  done_ = last_;
  write({});
}

MergedSky merge_sky(const Scene &scene, const RenderPlan &plan, const RenderOptions &options,
                    const std::vector<fs::path> &parts) {
  std::vector<PartHead> heads;
  for (const fs::path &path : parts) heads.push_back(read_part_head(path));
  const std::vector<std::size_t> order = order_of_parts(parts, heads);
  const auto &then = heads[order[0]].identity;
  const auto option = [&](const char *key) {
    const auto at = then.options.find(key);
    return at == then.options.end() ? std::string() : at->second;
  };
  PictureIdentity now = sky_identity(scene, plan, options, option("--lanes"));
  now.options["rows that stop by themselves"] = "0";
  std::vector<Diagnostic> wrong;
  for (const std::string &key : changed_keys(then, now))
    wrong.push_back({{parts[order[0]].string(), 1, 1}, "expected a part of the scene as it is now: " + key});
  if (!wrong.empty()) throw InputError(wrong);
  MergedSky out;
  SkyPicture picture(plan);
  std::map<std::string, std::vector<float>> channels;
  for (std::size_t s = 0; s < order.size(); ++s) {
    const fs::path &path = parts[order[s]];
    const SkyFile part = SkyFile::read(path, part_kind, "");
    const std::array<int, 2> rows = rows_of_share(picture.height(), heads[order[s]].share);
    if (part.first != rows[0] || part.last != rows[1] || part.done != part.last || !picture.set_rows(part.rows))
      throw InputError({path.string(), 1, 1}, "expected rows of this picture");
    if (s > 0) out.more_rays.add(part.rays);
    for (std::size_t c = 0; c < part.channels.size(); ++c)
      std::copy(part.channel_rows[c].begin(), part.channel_rows[c].end(),
                std::back_inserter(channels[part.channels[c]]));
  }
  out.noise_rms = picture.noise_rms();
  out.spp = picture.most_samples();
  out.image = picture.take();
  for (auto &[name, values] : channels) {
    if (values.size() != out.image.pixels())
      throw InputError({parts[order[0]].string(), 1, 1}, "expected channel '" + name + "' in all parts or in none");
    out.image.channels[name] = std::move(values);
  }
  out.report_json = heads[order[0]].report_json;
  return out;
}

}  // namespace greenray
