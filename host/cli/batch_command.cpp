// greenray batch: the sweep of a scene, or a list of jobs; what is done is skipped, what fails is told at the end.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "atmosphere/profile_file.hpp"
#include "cli/render_command.hpp"
#include "image/contact_sheet.hpp"
#include "render/renderer.hpp"
#include "scene/job_list.hpp"
#include "scene/room_scene.hpp"
#include "scene/scene_file.hpp"
#include "support/atomic_file.hpp"
#include "support/embedded.hpp"
#include "support/toml_reader.hpp"

namespace greenray::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const std::vector<std::string> not_passed_on{"--output", "--resume",  "--no-resume", "--jobs", "--json",
                                             "--quiet",  "--verbose", "--help",      "--set"};

struct Picture {
  Job job;
  Arguments arguments;  // of `render`
  fs::path exr;
  std::string key;
};

fs::path beside(const Picture &picture, const char *extension) {
  return fs::path(picture.exr).replace_extension(extension);
}

/// Sweeps of a scene, without its other keys: whether these are right shows with each picture.
std::vector<Job> jobs_of_scene(const std::string &file, const std::string &text, const Arguments &a) {
  const std::string name = fs::path(file).stem().string();
  const std::vector<SweepScene> sweeps = is_room_text(file, text) ? parse_room(file, text, a.all("--set")).sweeps
                                                                  : parse_scene(file, text, a.all("--set")).sweeps;
  if (sweeps.empty())
    throw InputError({file, 1, 1}, "expected a [[sweep]]: which key takes which values; see `greenray new`");
  const std::vector<std::vector<std::string>> pictures = pictures_of(sweeps);
  std::vector<Job> jobs;
  for (std::size_t i = 0; i < pictures.size(); ++i)
    jobs.push_back({a.positional()[0], numbered_name(name, i, pictures.size()), pictures[i], sweeps.front().place});
  return jobs;
}

std::vector<Job> jobs_from(const Arguments &a) {
  const std::string name = a.positional()[0];
  const SourcePlace place = a.positional_place(0);
  for (const std::string &file : {name, "scenes/" + name + ".toml"}) {
    std::optional<std::string> text = file_contents(file, max_toml_bytes, place);
    if (!text && file != name)
      if (const auto shipped = embedded_file(file)) text = std::string(*shipped);
    if (!text) continue;
    return is_job_list(file, *text) ? parse_jobs(file, *text) : jobs_of_scene(file, *text, a);
  }
  load_scene(name, {}, place);  // says what ships
  throw InputError(place, "'" + name + "': expected a scene or a list of jobs");
}

/// The command line of `render` that makes one picture; flags of this command go on to it.
std::vector<std::string> words_for(const Job &job, const fs::path &exr, const Arguments &a, const CommandSpec &spec) {
  std::vector<std::string> words{job.scene, "--output", exr.string(), "--quiet"};
  for (const Flag &flag : spec.flags) {
    if (!a.has(flag.name) || std::find(not_passed_on.begin(), not_passed_on.end(), flag.name) != not_passed_on.end())
      continue;
    words.push_back(flag.name);
    if (!flag.value.empty()) words.push_back(a.text(flag.name));
  }
  if (!a.has("--report"))
    words.insert(words.end(), {"--report", "off"});  // frames have one air: a page each tells nothing
  for (const std::vector<std::string> &some : {a.all("--set"), job.overrides})
    for (const std::string &assignment : some) words.insert(words.end(), {"--set", assignment});
  return words;
}

/// All pictures with their keys, so that what is wrong in any of them is told before the first is made.
std::vector<Picture> pictures_from(const std::vector<Job> &jobs, const fs::path &folder, const Arguments &a) {
  const CommandSpec spec = render_command().spec;
  std::vector<Picture> pictures;
  std::vector<Diagnostic> complaints;
  for (const Job &job : jobs) {
    const fs::path exr = folder / (job.name + ".exr");
    try {
      Picture picture{job, Arguments(spec, words_for(job, exr, a, spec)), exr, ""};
      picture.key = picture_key(picture.arguments);
      pictures.push_back(std::move(picture));
    } catch (const InputError &error) {
      for (const Diagnostic &d : error.diagnostics())
        complaints.push_back({d.place.file == "command line" ? job.place : d.place, job.name + ": " + d.message});
    }
  }
  if (complaints.size() > 20) {
    const std::size_t more = complaints.size() - 20;
    complaints.resize(20);
    complaints.back().message += "\nand " + std::to_string(more) + " more";
  }
  if (!complaints.empty()) throw InputError(std::move(complaints));
  return pictures;
}

bool is_done(const Picture &picture) {
  if (!fs::exists(picture.exr) || !fs::exists(beside(picture, ".png"))) return false;
  if (wants_report(picture.arguments) && !fs::exists(beside(picture, ".html"))) return false;
  std::ifstream file(beside(picture, ".json"));
  const Json report = Json::parse(file, nullptr, false);
  return report.is_object() && report.value("key", "") == picture.key;
}

/// Pictures in turn, on a few threads with a device each: while one writes its files another is on the device.
class BatchRun {
 public:
  BatchRun(std::vector<Picture> pictures, const Arguments &a)
      : pictures_(std::move(pictures)), json_(a.has("--json")), quiet_(a.has("--quiet")) {}

  void work(unsigned threads) {
    std::vector<std::thread> others;
    for (unsigned i = 1; i < threads; ++i) others.emplace_back([this] { take_pictures(); });
    take_pictures();
    for (std::thread &other : others) other.join();
    if (fatal_) std::rethrow_exception(fatal_);
    if (stop_requested())
      throw Interrupted("interrupted: " + std::to_string(done_ + skipped_) + " of " + std::to_string(pictures_.size()) +
                        " pictures are done; the same command goes on");
  }

  const std::vector<Diagnostic> &failed() const { return failed_; }
  std::size_t done() const { return done_; }
  std::size_t skipped() const { return skipped_; }

 private:
  void take_pictures() {
    Session session;
    for (std::size_t i; (i = next_.fetch_add(1)) < pictures_.size() && !stop_requested();) {
      try {
        take(pictures_[i], i, session);
      } catch (const Interrupted &) {
        return;
      } catch (...) {
        const std::lock_guard<std::mutex> guard(lock_);
        fatal_ = std::current_exception();
        next_ = pictures_.size();
      }
    }
  }

  void take(const Picture &picture, std::size_t i, Session &session) {
    if (is_done(picture)) return tell(i, "skipped", 0, "");
    const auto begin = std::chrono::steady_clock::now();
    try {
      render_picture(picture.arguments, session);
    } catch (const DeviceError &) {
      throw;  // it would be no better with the next picture
    } catch (const Interrupted &) {
      throw;
    } catch (const std::exception &error) {
      return tell(i, "failed", 0, error.what());
    }
    tell(i, "done", std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), "");
  }

  void tell(std::size_t i, const std::string &what, double seconds, const std::string &message) {
    const Picture &picture = pictures_[i];
    const std::lock_guard<std::mutex> guard(lock_);
    if (what == "failed") failed_.push_back({picture.job.place, picture.job.name + ": " + message});
    ++(what == "done" ? done_ : what == "skipped" ? skipped_ : failures_);
    if (json_) {
      Json line{{"event", "picture"},     {"name", picture.job.name}, {"number", i + 1},
                {"of", pictures_.size()}, {"status", what},           {"seconds", seconds}};
      if (!message.empty()) line["message"] = message;
      std::cout << line.dump() << std::endl;
    } else if (!quiet_ && what == "done") {
      std::cout << "done     " << i + 1 << "/" << pictures_.size() << "  " << picture.exr.string() << "  " << seconds
                << " s" << std::endl;
    }
  }

  const std::vector<Picture> pictures_;
  const bool json_, quiet_;
  std::atomic<std::size_t> next_{0};
  std::mutex lock_;
  std::size_t done_ = 0, skipped_ = 0, failures_ = 0;
  std::vector<Diagnostic> failed_;
  std::exception_ptr fatal_;
};

/// Thumbnails of every picture that there is, in order. returns: the file, or nothing where there are fewer than two
std::string write_sheet(const std::vector<Picture> &pictures, const fs::path &to) {
  std::vector<fs::path> files;
  for (const Picture &picture : pictures)
    if (fs::exists(beside(picture, ".png"))) files.push_back(beside(picture, ".png"));
  if (files.size() < 2) return "";
  write_png(to, contact_sheet(files));
  return to.string();
}

int batch(const Arguments &a) {
  const fs::path source = a.positional()[0];
  const std::string name = source.stem().string();
  const fs::path folder = a.has("--output") ? fs::path(a.text("--output")) : fs::path("out") / name;
  const auto threads = static_cast<unsigned>(a.optional_number("--jobs", 1, 64, "pictures").value_or(1));
  const std::vector<Picture> pictures = pictures_from(jobs_from(a), folder, a);
  std::error_code no_folder;  // told by the first picture
  fs::create_directories(folder, no_folder);
  BatchRun run(pictures, a);
  run.work(threads);
  const std::string sheet = write_sheet(pictures, folder / (name + "-sheet.png"));
  for (const Diagnostic &failure : run.failed()) std::cerr << "failed   " << failure.text() << "\n";
  if (a.has("--json"))
    std::cout << Json{{"event", "done"},
                      {"done", run.done()},
                      {"skipped", run.skipped()},
                      {"failed", run.failed().size()},
                      {"sheet", sheet}}
                     .dump()
              << "\n";
  else if (!a.has("--quiet"))
    std::cout << "batch    " << run.done() << " done, " << run.skipped() << " were done before, " << run.failed().size()
              << " failed" << (sheet.empty() ? "" : "; at a glance: " + sheet) << "\n";
  return run.failed().empty() ? 0 : static_cast<int>(ExitCode::run_failed);
}

}  // namespace

Command batch_command() {
  std::vector<Flag> flags{{"--output", "-o", "DIR", "folder of the pictures (out/NAME)"},
                          {"--jobs", "-j", "N", "pictures at a time, each with a device of its own (1)"}};
  for (const Flag &flag : render_flags())
    if (std::find(not_passed_on.begin(), not_passed_on.end(), flag.name) == not_passed_on.end() || flag.name == "--set")
      flags.push_back(flag);
  return {with_common(
              {"batch", "SCENE|JOBS", "Sweeps, frames and lists of pictures; what is done already is skipped.", flags}),
          batch};
}

}  // namespace greenray::cli
