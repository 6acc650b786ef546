// Suite eye: pictures a second through the whole human model, from file to display rows, beside tone mappers of
// pfstools.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "bench/device_methods.hpp"
#include "bench/race.hpp"
#include "bench/trace_suite.hpp"
#include "image/exr.hpp"
#include "image/picture_sink.hpp"
#include "image/picture_source.hpp"
#include "support/parallel.hpp"
#include "vision/human_eye.hpp"

namespace greenray::bench {
namespace {

namespace fs = std::filesystem;

/// Ten decades of clouds with a small low Sun; the same pixels every time.
RgbImage test_picture(int width, int height) {
  RgbImage image{width, height,
                 std::vector<float>(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
  std::uint32_t state = 1;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      state = state * 1664525U + 1013904223U;
      const double grain = 0.2 * (state / 4294967296.0 - 0.5);
      double level = std::exp(5 * std::sin(x / 90.0) * std::cos(y / 70.0) + 2 + grain);
      const bool disk = std::hypot(x - 0.5 * width, y - 0.35 * height) < 0.05 * height;
      if (disk) level = 1.5e5;
      image.set_pixel(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x),
                      {(disk ? 2.6 : 1.1) * level, (disk ? 0.6 : 1.0) * level, (disk ? 0.03 : 0.8) * level});
    }
  return image;
}

/// A folder that goes away with its files.
struct Scratch {
  fs::path folder = fs::temp_directory_path() / ("greenray-bench-eye-" + std::to_string(::getpid()));
  Scratch() { fs::create_directories(folder); }
  Scratch(const Scratch &) = delete;
  Scratch &operator=(const Scratch &) = delete;
  ~Scratch() {
    std::error_code error;
    fs::remove_all(folder, error);
  }
};

vision::EyeOptions full_model() {
  vision::EyeOptions options;
  options.fov_deg = 40;
  options.bleaching.exposure = vision::BleachingOptions::Exposure::seconds;
  options.bleaching.seconds = 3;
  return options;
}

/// Largest relative difference of the table that pixels are looked up in to the curve itself.
double tone_table_error() {
  std::vector<double> level, count;
  for (int i = 0; i <= 80; ++i) level.push_back(-3 + 0.1 * i), count.push_back(1 + std::abs(std::sin(i * 0.7)) * 20);
  const vision::ToneCurve curve(vision::histogram_from_table(level, count), {100, 100}, true);
  const vision::ToneTable table(curve);
  double worst = 0;
  for (double l = 2e-3; l < 1e5; l *= 1.003) {
    const double exact = curve.display_fraction(l);
    if (exact > 1e-3)
      worst = std::max(worst, std::abs(static_cast<double>(table.fraction(static_cast<float>(l))) / exact - 1));
  }
  return worst;
}

Record record_of(const std::string &name, const std::string &variant, const Timing &timing, int pictures,
                 double error) {
  Record record;
  record.suite = "eye";
  record.case_name = name;
  record.variant = variant;
  record.device = "host, " + std::to_string(host_threads()) + " threads";
  record.rate = pictures / timing.best_wall_seconds;
  record.rate_unit = "picture/s";
  record.error = error;
  record.error_unit = "relative (tone table)";
  record.cpu_seconds = timing.best_cpu_seconds / pictures;
  record.wall_seconds = timing.best_wall_seconds / pictures;
  record.median_rate = pictures / timing.median_wall_seconds;
  record.repeats = timing.repeats;
  return record;
}

double children_cpu_seconds() {
  rusage usage{};
  ::getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval &t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// A tone mapper of pfstools: from the EXR file to nowhere, the way its manual pipes them.
struct Operator {
  std::string name, command;
  double least_cpu_seconds = 1e300;
  void run() {
    const double before = children_cpu_seconds();
    (void)!std::system(command.c_str());
    least_cpu_seconds = std::min(least_cpu_seconds, children_cpu_seconds() - before);
  }
};

bool installed(const std::string &program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

std::string pfstools_version() {
  if (std::FILE *pipe = ::popen("dpkg-query -W -f='${Version}' pfstmo 2>/dev/null", "r")) {
    char text[64] = "";
    const bool read = std::fgets(text, sizeof text, pipe) != nullptr;
    ::pclose(pipe);
    if (read) return text;
  }
  return "unknown";
}

std::vector<Operator> installed_operators(const std::string &file) {
  std::vector<Operator> operators;
  for (const char *name : {"pfstmo_pattanaik00", "pfstmo_reinhard02", "pfstmo_mantiuk08"}) {
    if (!installed("pfsinexr") || !installed(name)) continue;
    const std::string command = "pfsinexr " + file + " | " + name + " >/dev/null 2>&1";
    if (std::system(command.c_str()) == 0) operators.push_back({name, command});
  }
  return operators;
}

/// One picture, from the file to display-linear rows and to PNG, beside the operators that are installed.
std::vector<Record> still_records(const fs::path &folder, int side, int repeats, double error,
                                  const std::function<void(const std::string &)> &say) {
  const std::string file = (folder / "still.exr").string();
  write_exr(file, test_picture(side, side));
  const auto to_rows = [&] {
    RgbImage seen;
    const auto source = open_picture(file);
    const auto sink = memory_sink(seen, side, side);
    vision::HumanEye(full_model()).develop(*source, *sink);
  };
  const auto to_png = [&] {
    AtomicFile out(folder / "still.png");
    const auto source = open_picture(file);
    const auto sink = png_sink(out, side, side);
    vision::HumanEye(full_model()).develop(*source, *sink);
    out.commit();
  };
  std::vector<Operator> operators = installed_operators(file);
  std::vector<std::function<void()>> entries{to_rows, to_png};
  for (Operator &o : operators) entries.emplace_back([&o] { o.run(); });
  if (say)
    say(operators.empty() ? "eye: still (no pfstmo operator beside it: Debian package pfstmo is not installed)"
                          : "eye: still");
  const std::vector<Timing> timings = race(entries, repeats);
  const std::string name = "still-" + std::to_string(side);
  std::vector<Record> records{
      record_of(name, "glare, acuity, colour, bleaching, from EXR to rows", timings[0], 1, error),
      record_of(name, "glare, acuity, colour, bleaching, from EXR to PNG", timings[1], 1, error)};
  for (std::size_t i = 0; i < operators.size(); ++i) {
    const double rate = 1 / timings[i + 2].best_wall_seconds;
    Record beside = records[0];
    beside.variant += " beside " + operators[i].name;
    beside.peer = PeerPoint{operators[i].name,
                            pfstools_version(),
                            "defaults, from EXR to a pipe",
                            rate,
                            error,
                            beside.rate / rate,
                            operators[i].least_cpu_seconds / beside.cpu_seconds};
    records.push_back(beside);
  }
  return records;
}

vision::EyeOptions film_model() {
  vision::EyeOptions eye = full_model();
  eye.carry_state = true;
  eye.bleaching.seconds = 1 / 24.0;
  return eye;
}

/// A film whose bleaching is carried on: frames in memory, and frames from EXR to PNG.
std::vector<Record> sequence_records(const fs::path &folder, int width, int height, int repeats, double error) {
  const RgbImage frame = test_picture(width, height);
  const std::string file = (folder / "frame.exr").string(), name = "sequence-" + std::to_string(height);
  write_exr(file, frame);
  constexpr int frames = 6;
  vision::HumanEye observer(film_model()), filer(film_model());
  RgbImage seen;
  const auto in_memory = [&] {
    for (int i = 0; i < frames; ++i) {
      const auto source = picture_source(frame, 40);
      const auto sink = memory_sink(seen, width, height);
      observer.develop(*source, *sink);
    }
  };
  const auto through_files = [&] {
    for (int i = 0; i < frames; ++i) {
      AtomicFile out(folder / "frame.png");
      const auto source = open_picture(file);
      const auto sink = png_sink(out, width, height);
      filer.develop(*source, *sink);
      out.commit();
    }
  };
  in_memory();
  const std::vector<Timing> timings = race({in_memory, through_files}, repeats);
  return {record_of(name, "frames in memory, state carried", timings[0], frames, error),
          record_of(name, "frames from EXR to PNG, state carried", timings[1], frames, error)};
}

}  // namespace

std::vector<Record> run_eye_suite(const SuiteOptions &options) {
  const Scratch scratch;
  const double error = tone_table_error();
  std::vector<Record> records;
  const int repeats = options.quick ? 1 : std::clamp(options.repeats, 3, 9);
  const auto keep = [&](const std::vector<Record> &some) {
    for (const Record &record : some) {
      if (options.done) options.done(record);
      records.push_back(record);
    }
  };
  keep(still_records(scratch.folder, options.quick ? 400 : 2000, repeats, error, options.say));
  if (options.say) options.say("eye: sequence");
  keep(sequence_records(scratch.folder, options.quick ? 480 : 1920, options.quick ? 270 : 1080, repeats, error));
  return records;
}

}  // namespace greenray::bench
