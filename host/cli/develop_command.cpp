// greenray develop: a picture as an eye, a camera or plain numbers would have it, from any EXR or Radiance picture.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/commands.hpp"
#include "cli/eye_flags.hpp"
#include "image/develop.hpp"
#include "image/picture_sink.hpp"
#include "image/picture_source.hpp"
#include "support/atomic_file.hpp"
#include "support/parallel.hpp"
#include "vision/report_json.hpp"

namespace greenray::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// out/a.png for the third of many: out/a-0003.png
fs::path numbered(const fs::path &path, std::size_t number, std::size_t count) {
  if (count == 1) return path;
  char tail[32];
  std::snprintf(tail, sizeof tail, "-%04zu", number + 1);
  return path.parent_path() / (path.stem().string() + tail + path.extension().string());
}

std::string output_name(const Arguments &a) {
  const std::string name = a.text("--output");
  const fs::path extension = fs::path(name).extension();
  if (extension != ".png" && extension != ".exr") a.fail("--output", "expected a file name that ends in .png or .exr");
  return name;
}

int bits_of(const Arguments &a) { return a.choice("--bits", {"8", "16"}, "8") == "16" ? 16 : 8; }

/// Display-linear rows into the file that `path` names; white_cd_m2: luminance of 1 in an EXR.
std::unique_ptr<PictureSink> display_sink(AtomicFile &file, const fs::path &path, const PictureFacts &facts, int bits,
                                          double white_cd_m2) {
  if (path.extension() == ".exr") return exr_sink(file, facts.width, facts.height, white_cd_m2);
  return png_sink(file, facts.width, facts.height, bits);
}

struct Developed {
  Json stats;
  std::string said;
};

void warn(const PictureFacts &facts, const vision::LightFaults &faults) {
  for (const std::string &note : facts.notes) std::cerr << "note: " << facts.name << ": " << note << "\n";
  const auto say = [&](std::uint64_t count, const char *what) {
    if (count > 0) std::cerr << "warning: " << facts.name << ": " << count << " pixels " << what << "\n";
  };
  say(faults.not_a_number, "are not numbers: each shows its nearest valid neighbour in the row, or black");
  say(faults.infinite, "are infinite: shown white, as bright as the brightest finite pixel");
  say(faults.negative, "have negative luminance: shown black");
  say(faults.too_bright, "are beyond 1e10 cd/m2: taken as that");
}

Developed develop_human(vision::HumanEye &eye, const vision::EyeOptions &options, PictureSource &picture,
                        const Arguments &a, const fs::path &out, const fs::path &greener, AtomicFileSet &files) {
  const PictureFacts &facts = picture.facts();
  AtomicFile &file = files.add(out);
  const auto sink = display_sink(file, out, facts, bits_of(a), options.display.max_cd_m2);
  vision::GreenerSinks sinks;
  std::unique_ptr<PictureSink> overlay, map;
  if (!greener.empty()) {
    overlay = png_sink(files.add(greener), facts.width, facts.height);
    map = exr_sink(files.add(fs::path(greener).replace_extension(".exr")), facts.width, facts.height, 0,
                   vision::greener_channels);
    sinks = {overlay.get(), map.get()};
  }
  const vision::EyeReport report = eye.develop(picture, *sink, sinks);
  warn(facts, report.faults);
  if (report.fov_assumed && (report.glare_applied || report.acuity_applied) && !a.has("--quiet"))
    std::cerr << "note: " << facts.name << ": does not say its field of view; taken as " << report.fov_deg
              << " deg wide (--fov)\n";
  std::ostringstream said;
  said << "  (pupil " << report.pupil_mm << " mm, adapted to " << report.adaptation_cd_m2 << " cd/m2, "
       << (report.linear ? "linear" : "histogram") << " tone map, " << report.gamut_moved
       << " pixels brought into gamut";
  if (options.map_greener) said << ", " << report.greener.pixels << " greener";
  said << ")";
  return {vision::report_json(report, options), said.str()};
}

/// Rows of a picture as scene-linear Rec. 709: as the file has them where it fits in memory, else read when needed.
class SceneRows {
 public:
  SceneRows(const fs::path &in, const SourceOptions &source, std::size_t memory_bytes)
      : picture_(open_picture(in, {source.unit_cd_m2, false, true})) {
    const std::size_t needed = 4 * 3 * sizeof(float) * picture_->facts().pixels();
    if (needed <= memory_bytes) whole_ = read_rgb(*picture_);
  }
  const PictureFacts &facts() const { return picture_->facts(); }
  bool in_memory() const { return !whole_.rgb.empty(); }

  /// work(first row, rows, rgb) for pieces of the picture, on all cores.
  template <class Work>
  void for_rows(Work &&work) {
    const auto width = static_cast<std::size_t>(facts().width);
    for_pieces(static_cast<std::size_t>(facts().height), 64, host_threads(), [&](std::size_t from, std::size_t to) {
      const int first = static_cast<int>(from), rows = static_cast<int>(to - from);
      if (in_memory()) return work(first, rows, whole_.rgb.data() + 3 * width * from);
      const std::vector<float> rgb = read_rgb_rows(*picture_, first, rows);
      work(first, rows, rgb.data());
    });
  }

 private:
  std::unique_ptr<PictureSource> picture_;
  RgbImage whole_;
};

Developed develop_camera_view(SceneRows &scene, const Arguments &a, const fs::path &out, AtomicFileSet &files) {
  const PictureFacts &facts = scene.facts();
  const auto width = static_cast<std::size_t>(facts.width);
  const CameraOptions options{a.optional_number("--exposure", -60, 60, "EV"), bits_of(a), true};
  ExposureKey key;
  do scene.for_rows([&](int, int rows, const float *rgb) { key.look(rgb, width * static_cast<std::size_t>(rows)); });
  while (key.again());
  CameraReport report;
  report.key_cd_m2 = key.cd_m2();
  AtomicFile &file = files.add(out);
  // a picture in memory becomes the very bytes that `render` writes
  const bool as_rendered = scene.in_memory() && out.extension() == ".png";
  RgbImage whole;
  const auto sink =
      as_rendered ? memory_sink(whole, facts.width, facts.height) : display_sink(file, out, facts, bits_of(a), 1);
  std::mutex lock;
  scene.for_rows([&](int first, int rows, const float *rgb) {
    const std::size_t count = width * static_cast<std::size_t>(rows);
    std::vector<float> display(3 * count);
    CameraReport here;
    here.key_cd_m2 = key.cd_m2();
    camera_rows(options, here, rgb, count, display.data());
    sink->put(first, rows, std::move(display));
    const std::lock_guard<std::mutex> guard(lock);
    report.gamut_moved += here.gamut_moved, report.replaced += here.replaced, report.exposure_ev = here.exposure_ev;
  });
  sink->finish();
  if (as_rendered) write_png(file, quantise(whole, bits_of(a)));
  warn(facts, {0, 0, 0, 0});
  std::ostringstream said;
  said << "  (key " << report.key_cd_m2 << " cd/m2, " << report.gamut_moved << " pixels brought into gamut)";
  return {{{"observer", "camera"},
           {"key_cd_m2", report.key_cd_m2},
           {"exposure_ev", report.exposure_ev},
           {"pixels", {{"total", facts.pixels()}, {"gamut_moved", report.gamut_moved}, {"replaced", report.replaced}}}},
          said.str()};
}

/// Photometrically linear: a display whose white is Ldmax shows the scene's own luminances, cut off above. To EXR:
/// cd/m2.
Developed develop_linear(PictureSource &picture, const Arguments &a, const fs::path &out, AtomicFileSet &files) {
  const PictureFacts &facts = picture.facts();
  const bool to_exr = out.extension() == ".exr";
  const double ev = a.optional_number("--exposure", -60, 60, "EV").value_or(0);
  const auto gain = static_cast<float>(std::exp2(ev) / (to_exr ? 1 : display_from(a).max_cd_m2));
  AtomicFile &file = files.add(out);
  const auto sink = to_exr ? exr_sink(file, facts.width, facts.height, facts.absolute ? 1 : 0)
                           : png_sink(file, facts.width, facts.height, bits_of(a));
  vision::LightStore store(picture, 0);
  vision::LightFaults faults;
  std::mutex lock;
  std::uint64_t moved = 0;
  for_pieces(static_cast<std::size_t>(facts.height), 64, host_threads(), [&](std::size_t first, std::size_t last) {
    std::vector<float> light;
    const vision::LightFaults here = store.load(static_cast<int>(first), static_cast<int>(last - first), light);
    const std::size_t count = (last - first) * static_cast<std::size_t>(facts.width);
    std::vector<float> rgb = vision::linear_rgb(light, count);
    for (float &value : rgb) value *= gain;
    const std::size_t out_of_gamut = to_exr ? 0 : vision::gamut_rows(count, rgb.data());
    sink->put(static_cast<int>(first), static_cast<int>(last - first), std::move(rgb));
    const std::lock_guard<std::mutex> guard(lock);
    faults.add(here);
    moved += out_of_gamut;
  });
  sink->finish();
  warn(facts, faults);
  return {{{"observer", "linear"},
           {"exposure_ev", ev},
           {"pixels",
            {{"total", facts.pixels()},
             {"not_a_number", faults.not_a_number},
             {"infinite", faults.infinite},
             {"negative", faults.negative},
             {"too_bright", faults.too_bright},
             {"gamut_moved", moved}}}},
          "  (linear)"};
}

/// A histogram file: log10 of cd/m2 and a count on each line; blank lines and `#` comments are skipped.
std::pair<std::vector<double>, std::vector<double>> read_histogram(const std::string &name) {
  std::ifstream file(name);
  if (!file) throw InputError({name, 1, 1}, "expected a histogram, found no readable file");
  std::pair<std::vector<double>, std::vector<double>> columns;
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    for (char &c : line) c = c == ',' || c == '\t' || c == '\r' ? ' ' : c;
    const std::size_t begin = line.find_first_not_of(' ');
    if (begin == std::string::npos || line[begin] == '#') continue;
    std::istringstream words(line);
    double level = 0, count = 0;
    std::string rest;
    if (!(words >> level >> count) || (words >> rest))
      throw InputError({name, number, static_cast<int>(begin) + 1},
                       "expected two numbers: log10 of cd/m2, and a count");
    columns.first.push_back(level), columns.second.push_back(count);
  }
  return columns;
}

int map_histogram(const Arguments &a) {
  if (!a.has("--map")) a.fail("--histogram", "expected --map OUT beside it, where the map is written");
  if (!a.positional().empty())
    throw InputError(a.positional_place(0), "expected either a picture or --histogram, found both");
  for (const char *flag : {"--output", "--stats", "--greener", "--observer", "--exposure", "--bleaching"})
    if (a.has(flag)) a.fail(flag, "expected a picture with this flag, not --histogram");
  const auto [level, count] = read_histogram(a.text("--histogram"));
  try {
    const vision::ToneCurve curve(vision::histogram_from_table(level, count), display_from(a),
                                  on_or_off(a, "--sensitivity", true));
    std::string text;
    for (const auto &[world, shown] : curve.table()) {
      char line[80];
      std::snprintf(line, sizeof line, "%.9e %.9e\n", world, shown);
      text += line;
    }
    write_file_atomically(a.text("--map"), text);
    if (!a.has("--quiet"))
      std::cout << "wrote    " << a.text("--map") << (curve.is_linear() ? "  (linear)" : "") << "\n";
  } catch (const std::domain_error &error) {
    throw InputError({a.text("--histogram"), 1, 1}, error.what());
  }
  return 0;
}

/// What was asked for; a flag that only an eye has asks for one.
std::string observer_of(const Arguments &a) {
  bool eye = a.has("--greener");
  for (const Flag &flag : eye_flags())
    if (flag.name != "--ldmax") eye = eye || a.has(flag.name);
  const std::string observer = a.choice("--observer", {"human", "camera", "linear"}, eye ? "human" : "camera");
  if (observer != "human" && a.has("--greener"))
    a.fail("--greener", "expected --observer human with this flag: a " + observer + " has no eye");
  if (eye && observer != "human")
    for (const Flag &flag : eye_flags())
      if (a.has(flag.name) && flag.name != "--ldmax")
        a.fail(flag.name, "expected --observer human with this flag: a " + observer + " has no eye");
  if (a.has("--exposure") && observer == "human")
    a.fail("--exposure", "expected --observer camera or linear with this flag: an eye adapts by itself");
  return observer;
}

/// Complains about two outputs of one name, of which one would be lost.
void check_outputs_differ(const Arguments &a) {
  std::vector<fs::path> before{fs::absolute(a.text("--output")).lexically_normal()};
  const auto add = [&](const char *flag, const fs::path &name) {
    const fs::path path = fs::absolute(name).lexically_normal();
    if (std::find(before.begin(), before.end(), path) != before.end())
      a.fail(flag, "expected another file: " + name.string() + " is written already");
    before.push_back(path);
  };
  if (a.has("--greener")) {
    add("--greener", a.text("--greener"));
    add("--greener", fs::path(a.text("--greener")).replace_extension(".exr"));
  }
  if (a.has("--stats")) add("--stats", a.text("--stats"));
}

/// Opens every picture of a sequence, so that nothing is written where one of them cannot be developed.
void check_sequence(const Arguments &a, const SourceOptions &source, const vision::HumanEye *eye) {
  PictureFacts first;
  for (std::size_t i = 0; i < a.positional().size(); ++i) {
    const PictureFacts facts = open_picture(a.positional()[i], source)->facts();
    if (i == 0) first = facts;
    if (eye) eye->check(facts, &first);
  }
}

int develop(const Arguments &a) {
  if (a.has("--histogram")) return map_histogram(a);
  if (a.has("--map")) a.fail("--map", "expected --histogram FILE beside it");
  if (a.positional().empty())
    throw InputError({"command line", 1, 18}, "expected IN.exr: `greenray develop IN.exr -o OUT.png`");
  if (!a.has("--output")) throw InputError({"command line", 1, 18}, "missing --output OUT.png: where to write");
  const std::string observer = observer_of(a), out_name = output_name(a);
  const std::string greener = a.has("--greener") ? a.file("--greener", ".png") : "";
  check_outputs_differ(a);
  vision::EyeOptions options = eye_options(a);
  SourceOptions source{a.optional_number("--unit", 1e-30, 1e30, "cd/m2"), true};
  const std::size_t count = a.positional().size();
  options.carry_state = count > 1;
  vision::HumanEye eye(options);
  if (count > 1) check_sequence(a, source, observer == "human" ? &eye : nullptr);
  Json all = Json::array();
  for (std::size_t i = 0; i < count; ++i) {
    const fs::path out = numbered(out_name, i, count);
    const fs::path map = greener.empty() ? fs::path() : numbered(greener, i, count);
    AtomicFileSet files;
    Developed done;
    try {
      if (observer == "camera") {
        SceneRows scene(a.positional()[i], source, options.memory_bytes);
        done = develop_camera_view(scene, a, out, files);
      } else {
        const std::unique_ptr<PictureSource> picture = open_picture(a.positional()[i], source);
        done = observer == "human" ? develop_human(eye, options, *picture, a, out, map, files)
                                   : develop_linear(*picture, a, out, files);
      }
    } catch (const std::domain_error &error) {
      throw InputError(a.positional_place(i), error.what());
    }
    all.push_back(done.stats);
    if (a.has("--stats") && i + 1 == count)
      files.add(a.text("--stats")).write((count == 1 ? all[0] : Json{{"frames", all}}).dump(1) + "\n");
    files.commit();
    if (a.has("--json")) std::cout << done.stats.dump() << "\n";
    else if (!a.has("--quiet")) std::cout << "wrote    " << out.string() << done.said << "\n";
  }
  return 0;
}

}  // namespace

Command develop_command() {
  std::vector<Flag> flags{
      {"--output", "-o", "OUT.png", "where to write: .png, or .exr (linear); several inputs: OUT-0001.png .."},
      {"--observer", "", "O", "camera (default) | human (default with a flag of the eye) | linear"},
      {"--exposure", "", "EV", "camera, linear: stops on top"},
      {"--bits", "", "8|16", "of a PNG (8)"},
      {"--unit", "", "CDM2", "luminance of RGB (1,1,1), or of Y = 1, where the file does not say (or is wrong)"},
      {"--greener", "", "MAP.png", "mark pixels that bleaching makes greener; numbers go to MAP.exr"},
      {"--stats", "", "FILE.json", "every number of the eye"},
      {"--histogram", "", "FILE", "no picture: the tone map of this histogram (log10 cd/m2, count) .."},
      {"--map", "", "OUT", ".. as 100 lines: world cd/m2, display cd/m2"}};
  for (Flag &flag : eye_flags()) flags.push_back(std::move(flag));
  return {
      with_common({"develop", "[IN.exr...]",
                   "A picture as an eye, a camera or plain numbers have it, from any EXR or Radiance .hdr.", flags}),
      develop};
}

}  // namespace greenray::cli
