// greenray devices [--test]: what OpenCL offers here, and whether its arithmetic is sound.
#include <iomanip>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/commands.hpp"
#include "render/self_test.hpp"

namespace greenray::cli {
namespace {

nlohmann::json describe(const DeviceInfo &d) {
  return {{"address", d.address()},
          {"name", d.name},
          {"platform", d.platform_name},
          {"driver", d.driver},
          {"version", d.version},
          {"type", d.is_gpu   ? "gpu"
                   : d.is_cpu ? "cpu"
                              : "other"},
          {"compute_units", d.compute_units},
          {"memory_bytes", d.memory_bytes},
          {"double", d.has_double},
          {"images", d.has_images}};
}

int list(const Arguments &a) {
  const auto devices = list_devices();
  if (devices.empty()) (void)open_devices({});  // says what to install
  if (a.has("--json")) {
    nlohmann::json out = nlohmann::json::array();
    for (const DeviceInfo &d : devices) out.push_back(describe(d));
    emit(a, out.dump(1) + "\n");
    return 0;
  }
  std::ostringstream out;
  for (const DeviceInfo &d : devices)
    out << d.address() << "  " << d.name << " (" << d.platform_name << ", " << d.driver << "), "
        << (d.is_gpu   ? "GPU"
            : d.is_cpu ? "CPU"
                       : "other")
        << ", " << d.compute_units << " units, " << std::fixed << std::setprecision(1)
        << static_cast<double>(d.memory_bytes) / 1e9 << " GB" << (d.has_double ? ", double" : "")
        << (d.has_images ? ", images" : "") << "\n";
  emit(a, out.str());
  return 0;
}

int test(const Arguments &a) {
  DeviceOptions options = device_options(a);
  if (options.select.empty()) options.select = "all";
  bool all_passed = true;
  nlohmann::json out = nlohmann::json::array();
  std::ostringstream text;
  for (const auto &device : open_devices(options)) {
    nlohmann::json entry = describe(device->info());
    text << device->info().address() << "  " << device->info().name << "\n";
    for (const SelfTestResult &r : self_test(device)) {
      all_passed = all_passed && r.passed;
      text << "  " << (r.passed ? "ok    " : "FAILED") << "  " << r.name << ": " << r.detail << "\n";
      entry["tests"].push_back({{"name", r.name}, {"passed", r.passed}, {"detail", r.detail}});
    }
    entry["compile_seconds"] = device->compile_seconds();
    out.push_back(entry);
  }
  emit(a, a.has("--json") ? out.dump(1) + "\n" : text.str());
  if (!all_passed) throw RunError("a device failed its known-answer test: do not trust its pictures");
  return 0;
}

}  // namespace

Command devices_command() {
  return {with_common({"devices",
                       "",
                       "Lists OpenCL devices; with --test runs kernels with known answers on them.",
                       {{"--test", "", "", "run known-answer kernels on all devices, or on --device"}}}),
          [](const Arguments &a) { return a.has("--test") ? test(a) : list(a); }};
}

}  // namespace greenray::cli
