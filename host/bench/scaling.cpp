#include "bench/scaling.hpp"

#include <algorithm>

#include "bench/device_methods.hpp"
#include "bench/entrant.hpp"

namespace greenray::bench {
namespace {

constexpr double layer_error_arcsec = 0.01;

CaseAir standard_air(const std::string &name, std::size_t wavelengths = 1) {
  CaseAir air{name, {}, 2, 1e-4, 5};
  if (wavelengths > 1) air.wavelengths_nm.clear();
  for (std::size_t i = 0; wavelengths > 1 && i < wavelengths; ++i)
    air.wavelengths_nm.push_back(400 + 300.0 * static_cast<double>(i) / static_cast<double>(wavelengths - 1));
  return air;
}

/// The two methods whose growth is watched, their names made unlike those of other cases by `at`.
std::vector<Method> watched(const std::shared_ptr<Device> &device, const SuiteOptions &options, const std::string &at) {
  std::vector<Method> methods{closed_form_method(device, Precision::single_, layer_error_arcsec),
                              stepping_method(device)};
  std::erase_if(methods, [&](const Method &m) { return m.variant.find(options.only) == std::string::npos; });
  for (Method &m : methods) m.variant += ", " + at;
  return methods;
}

/// One point of a case: methods on their rays, `value` of what is varied.
struct Point {
  std::vector<Method> methods;
  std::shared_ptr<TraceCase> rays;
  std::size_t altitudes;
  double value;
};

/// Times all points in turn; `name` is what is varied.
std::vector<Record> run_points(const std::vector<Point> &points, const std::string &name, const SuiteOptions &options) {
  std::vector<Entrant> entrants;
  std::vector<double> values;
  for (const Point &p : points)
    for (const Method &m : p.methods) {
      if (options.say) options.say(p.rays->air().name + ": prepare " + m.variant);
      entrants.push_back(prepare(m, *p.rays, p.altitudes));
      values.push_back(p.value);
    }
  std::vector<Record> records;
  if (entrants.empty()) return records;
  const std::vector<Timing> timings = race(entrants, options);
  for (std::size_t i = 0; i < entrants.size(); ++i) {
    records.push_back(record_of(entrants[i], timings[i]));
    records.back().more[name] = values[i];
  }
  for (Record &r : records) {
    const Record &first =
        *std::find_if(records.begin(), records.end(), [&](const Record &other) { return other.curve() == r.curve(); });
    r.more["speed_up"] = r.rate / first.rate;
    r.more["cpu_speed_up"] = r.number("rays") / r.cpu_seconds / (first.number("rays") / first.cpu_seconds);
    if (options.done) options.done(r);
  }
  return records;
}

/// By device fission; a device that is no CPU has no cores to take away.
std::vector<Record> over_cores(const std::shared_ptr<Device> &device, const SuiteOptions &options) {
  if (!device->info().is_cpu) return {};
  std::vector<unsigned> counts = options.scale;
  if (counts.empty()) counts = {1, device->info().compute_units};
  std::sort(counts.begin(), counts.end());
  counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
  const auto rays =
      std::make_shared<TraceCase>(standard_air("cores"), options.quick ? 1024 : 524288, 100, options.threads);
  std::vector<Point> points;
  for (const unsigned threads : counts) {
    DeviceOptions part = options.device;
    part.threads = threads;
    const std::string at = std::to_string(threads) + (threads == 1 ? " core" : " cores");
    points.push_back({watched(open_device(part), options, at), rays, rays->timed_rays(), double(threads)});
  }
  return run_points(points, "threads", options);
}

std::vector<Record> over_rays(const std::shared_ptr<Device> &device, const SuiteOptions &options) {
  const std::vector<std::size_t> counts = options.quick ? std::vector<std::size_t>{256, 1024}
                                                        : std::vector<std::size_t>{4096, 16384, 65536, 262144, 1048576};
  const auto rays = std::make_shared<TraceCase>(standard_air("rays"), counts.back(), 100, options.threads);
  std::vector<Point> points;
  for (const std::size_t count : counts)
    points.push_back({watched(device, options, std::to_string(count) + " rays"), rays, count, double(count)});
  return run_points(points, "rays", options);
}

std::vector<Record> over_wavelengths(const std::shared_ptr<Device> &device, const SuiteOptions &options) {
  const std::vector<std::size_t> counts =
      options.quick ? std::vector<std::size_t>{1, 2} : std::vector<std::size_t>{1, 2, 4, 8, 16, 32};
  std::vector<Point> points;
  for (const std::size_t waves : counts) {
    const auto rays = std::make_shared<TraceCase>(standard_air("wavelengths", waves), options.quick ? 256 : 8192, 20,
                                                  options.threads);
    const std::string at = std::to_string(waves) + (waves == 1 ? " wavelength" : " wavelengths");
    points.push_back({watched(device, options, at), rays, rays->timed_rays(), double(waves)});
  }
  return run_points(points, "wavelengths", options);
}

}  // namespace

std::vector<Record> run_scaling(const SuiteOptions &options) {
  const std::shared_ptr<Device> device = open_device(options.device);
  std::vector<Record> all;
  for (const auto &records :
       {over_cores(device, options), over_rays(device, options), over_wavelengths(device, options)})
    all.insert(all.end(), records.begin(), records.end());
  return all;
}

}  // namespace greenray::bench
