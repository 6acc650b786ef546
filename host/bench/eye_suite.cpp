// Suite eye: pictures a second through the whole human model, from file to display rows, beside tone mappers of
// pfstools.
#include <unistd.h>

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

Record record_of(const std::string &name, const std::string &variant, const Timing &timing, double error) {
  Record record;
  record.suite = "eye";
  record.case_name = name;
  record.variant = variant;
  record.device = "host, " + std::to_string(host_threads()) + " threads";
  record.rate = 1 / timing.best_wall_seconds;
  record.rate_unit = "picture/s";
  record.error = error;
  record.error_unit = "relative (tone table)";
  record.cpu_seconds = timing.best_cpu_seconds;
  record.wall_seconds = timing.best_wall_seconds;
  record.median_rate = 1 / timing.median_wall_seconds;
  record.repeats = timing.repeats;
  return record;
}

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

}  // namespace

std::vector<Record> run_eye_suite(const SuiteOptions &options) {
  const Scratch scratch;
  const double error = tone_table_error();
  std::vector<Record> records;
  const int repeats = options.quick ? 1 : std::clamp(options.repeats, 3, 9);
  const auto keep = [&](Record record) {
    if (options.done) options.done(record);
    records.push_back(std::move(record));
  };
  const int side = options.quick ? 400 : 2000;
  const std::string file = (scratch.folder / "still.exr").string();
  write_exr(file, test_picture(side, side));

  // one picture, from the file to display-linear rows
  RgbImage seen;
  const auto still = [&] {
    const auto source = open_picture(file);
    const auto sink = memory_sink(seen, side, side);
    vision::HumanEye(full_model()).develop(*source, *sink);
  };
  std::vector<std::function<void()>> entries{still};
  std::vector<std::string> peers;
  for (const char *peer : {"pfstmo_pattanaik00", "pfstmo_reinhard02", "pfstmo_mantiuk08"})
    if (installed("pfsinexr") && installed(peer)) {
      const std::string command = "pfsinexr " + file + " | " + peer + " >/dev/null 2>&1";
      if (std::system(command.c_str()) != 0) continue;
      peers.emplace_back(peer);
      entries.emplace_back([command] { (void)!std::system(command.c_str()); });
    }
  if (options.say) options.say("eye: still");
  still();
  const std::vector<Timing> timings = race(entries, repeats);
  const std::string name = "still-" + std::to_string(side);
  Record ours = record_of(name, "glare, acuity, colour, bleaching, from EXR", timings[0], error);
  for (std::size_t i = 0; i < peers.size(); ++i) {
    const double rate = 1 / timings[i + 1].best_wall_seconds;
    Record with_peer = ours;
    with_peer.variant += " beside " + peers[i];
    with_peer.peer = PeerPoint{peers[i], pfstools_version(), "defaults, from EXR", rate, error, ours.rate / rate, 0};
    keep(with_peer);
  }
  if (peers.empty()) keep(ours);

  // a sequence in memory, its bleaching carried on
  const int w = options.quick ? 480 : 1920, h = options.quick ? 270 : 1080;
  const RgbImage frame = test_picture(w, h);
  vision::EyeOptions eye = full_model();
  eye.carry_state = true;
  eye.bleaching.seconds = 1 / 24.0;
  vision::HumanEye observer(eye);
  const auto one_frame = [&] {
    const auto source = picture_source(frame, 40);
    const auto sink = memory_sink(seen, w, h);
    observer.develop(*source, *sink);
  };
  if (options.say) options.say("eye: sequence");
  one_frame();
  keep(record_of("sequence-" + std::to_string(h), "frames in memory, state carried", race({one_frame}, 2 * repeats)[0],
                 error));
  return records;
}

}  // namespace greenray::bench
