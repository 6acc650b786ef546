// Rooms of suite scenes: RMS error of a pixel against the seconds of the picture, by number of photons.
#include <algorithm>
#include <cmath>

#include "bench/device_methods.hpp"
#include "bench/machine.hpp"
#include "bench/trace_suite.hpp"
#include "render/room.hpp"
#include "support/embedded.hpp"

namespace greenray::bench {
namespace {

struct Picture {
  RoomPicture picture;
  Clocks took;
  double seconds() const { return took.wall_seconds - picture.report.compile_seconds; }
};

Picture render_once(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device) {
  const Clocks begin = clocks_now();
  RoomPicture picture = render_room(scene, options, device);
  const Clocks end = clocks_now();
  return {std::move(picture), {end.wall_seconds - begin.wall_seconds, end.cpu_seconds - begin.cpu_seconds}};
}

/* RMS over the pixels of the difference of sums over the wavelengths, over the reference's mean; the reference's own
   noise is independent and taken off. */
double true_error(const SpectralImage &image, const RoomPicture &reference) {
  const std::size_t waves = image.wavelength_nm.size();
  double squares = 0, whole = 0;
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    double difference = 0;
    for (std::size_t w = p * waves; w < (p + 1) * waves; ++w) {
      const double truth = static_cast<double>(reference.image.radiance[w]);
      difference += static_cast<double>(image.radiance[w]) - truth, whole += truth;
    }
    squares += difference * difference;
  }
  const double pixels = static_cast<double>(image.pixels()), level = whole / pixels;
  const double apart2 = squares / pixels / (level * level);
  return std::sqrt(std::max(0.0, apart2 - reference.report.noise_rms * reference.report.noise_rms));
}

Record record_of(const std::string &name, const std::string &way, const std::vector<Picture> &pictures,
                 const RoomPicture &reference, const Device &device) {
  std::vector<double> wall;
  const Picture *best = &pictures[0];
  for (const Picture &p : pictures) {
    wall.push_back(p.seconds());
    if (p.seconds() < best->seconds()) best = &p;
  }
  std::sort(wall.begin(), wall.end());
  const RoomReport &r = best->picture.report;
  Record record;
  record.suite = "scenes";
  record.case_name = name;
  record.variant = way + ", " + std::to_string(r.photons.photons) + " photons";
  record.device = device_words(device);
  record.kind = {"", "", way, "float", device.lanes().lanes_float};
  record.rate = 1 / wall.front();
  record.rate_unit = "picture/s";
  record.error = true_error(best->picture.image, reference);
  record.error_unit = "RMS, relative";
  record.cpu_seconds = best->took.cpu_seconds;
  record.wall_seconds = wall.front();
  record.median_rate = 1 / wall[wall.size() / 2];
  record.repeats = static_cast<int>(pictures.size());
  record.more = {{"claimed_rms", r.error_rms},
                 {"noise_rms", r.noise_rms},
                 {"bias_rms", r.bias_rms},
                 {"pixels", static_cast<double>(best->picture.image.pixels())},
                 {"photons", static_cast<double>(r.photons.photons)},
                 {"reference_photons", static_cast<double>(reference.report.photons.photons)},
                 {"reference_claimed_rms", reference.report.error_rms},
                 {"samples_per_pixel", r.spp},
                 {"build_seconds", r.build_seconds},
                 {"emit_seconds", r.emit_seconds},
                 {"map_seconds", r.map_seconds},
                 {"gather_seconds", r.gather_seconds},
                 {"eye_seconds", r.eye_seconds}};
  return record;
}

RoomScene shipped_room(const std::string &name) {
  const std::string file = "scenes/" + name + ".toml";
  return parse_room(file, embedded_file(file).value());
}

/* Passes of the same few photons, four times as many each time: noise and bias both fall as passes^(-1/3) by Knaus &
   Zwicker. The reference has passes of eight times the photons, in a kernel of twice as many: a quarter of the area. */
std::vector<Record> converge(const std::string &name, RoomScene scene, RoomOptions room, const SuiteOptions &options,
                             const std::shared_ptr<Device> &device) {
  const std::int64_t each = options.quick ? 2000 : 16000;
  const int most = options.quick ? 16 : 64;
  RoomScene finer = scene;
  finer.photons.gather *= 2;
  RoomOptions better = room;
  better.seed = 4243, better.photons = 8 * each * most, better.passes = most, better.spp = most;
  if (options.say) options.say(name + ": reference of convergence");
  const RoomPicture reference = render_room(finer, better, device);
  std::vector<Record> records;
  for (int passes = 4; passes <= most; passes *= 4) {
    room.passes = passes, room.photons = each * passes, room.spp = passes;
    if (options.say) options.say(name + ": " + std::to_string(passes) + " passes");
    records.push_back(record_of(name, "progressive", {render_once(scene, room, device)}, reference, *device));
    records.back().more["passes"] = passes;
  }
  const double slope = convergence_slope(records);
  for (Record &record : records) {
    record.more["slope"] = slope;
    if (options.done) options.done(record);
  }
  return records;
}

}  // namespace

double convergence_slope(const std::vector<Record> &records) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const Record &r : records) {
    if (!(r.error > 0) || !(r.number("photons") > 0)) continue;
    const double a = std::log(r.number("photons")), b = std::log(r.error);
    n += 1, x += a, y += b, xx += a * a, xy += a * b;
  }
  return n > 1 ? (n * xy - x * y) / (n * xx - x * x) : 0;
}

std::vector<Record> run_rooms(const SuiteOptions &options, const std::shared_ptr<Device> &device) {
  std::vector<Record> records;
  const std::int64_t most = options.quick ? 60000 : 1000000;
  for (const char *name : {"cross-room", "prism-caustic"}) {
    const RoomScene scene = shipped_room(name);
    const auto say = [&](const std::string &what) {
      if (options.say) options.say(std::string(name) + ": " + what);
    };
    RoomOptions room;
    const int shrink = options.quick ? 10 : 2;
    room.size = {scene.camera.resolution[0] / shrink, scene.camera.resolution[1] / shrink};
    RoomOptions better = room;
    better.seed = 4242, better.photons = 16 * most, better.spp = 64;
    say("reference");
    const RoomPicture reference = render_room(scene, better, device);  // warms up, too
    for (std::int64_t photons = most / 16; photons <= most; photons *= 4) {
      room.photons = photons;
      std::vector<Picture> pictures;
      for (int i = 0; i < (options.quick ? 1 : std::clamp(options.repeats / 2, 1, 3)); ++i) {
        say(std::to_string(photons) + " photons");
        pictures.push_back(render_once(scene, room, device));
      }
      records.push_back(record_of(name, "photon map", pictures, reference, *device));
      if (options.done) options.done(records.back());
    }
    for (Record &record : converge(name, scene, room, options, device)) records.push_back(std::move(record));
  }
  return records;
}

}  // namespace greenray::bench
