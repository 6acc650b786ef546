#include "compute/device.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "compute/device_state.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

constexpr const char *install_hint =
    "no OpenCL device: install the CPU driver with `apt-get install pocl-opencl-icd`, or your GPU vendor's driver";

struct Found {
  DeviceInfo info;
  cl::Device device;
};

DeviceInfo describe(const cl::Device &device) {
  DeviceInfo d;
  d.name = device.getInfo<CL_DEVICE_NAME>();
  d.driver = device.getInfo<CL_DRIVER_VERSION>();
  d.version = device.getInfo<CL_DEVICE_VERSION>();
  const cl_device_type type = device.getInfo<CL_DEVICE_TYPE>();
  d.is_cpu = type & CL_DEVICE_TYPE_CPU;
  d.is_gpu = type & CL_DEVICE_TYPE_GPU;
  d.has_double = device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() != 0;
  d.has_images = device.getInfo<CL_DEVICE_IMAGE_SUPPORT>();
  d.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  d.memory_bytes = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  d.largest_buffer_bytes = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  d.image_width_max = d.has_images ? device.getInfo<CL_DEVICE_IMAGE2D_MAX_WIDTH>() : 0;
  d.image_height_max = d.has_images ? device.getInfo<CL_DEVICE_IMAGE2D_MAX_HEIGHT>() : 0;
  return d;
}

std::vector<Found> find_all() {
  guard_pocl_cache();
  std::vector<Found> found;
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error &) {
    return found;  // no driver installed: the loader says so with an error
  }
  for (std::size_t p = 0; p < platforms.size(); ++p) {
    std::vector<cl::Device> devices;
    try {
      platforms[p].getDevices(CL_DEVICE_TYPE_ALL, &devices);
    } catch (const cl::Error &) {
      continue;  // a platform without devices
    }
    for (std::size_t i = 0; i < devices.size(); ++i) {
      Found f{describe(devices[i]), devices[i]};
      f.info.platform = static_cast<int>(p);
      f.info.index = static_cast<int>(i);
      f.info.flat_index = static_cast<int>(found.size());
      f.info.platform_name = platforms[p].getInfo<CL_PLATFORM_NAME>();
      found.push_back(std::move(f));
    }
  }
  return found;
}

std::string lower(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return s;
}

bool is_pocl(const DeviceInfo &d) { return lower(d.platform_name).find("portable computing") != std::string::npos; }

bool matches(const DeviceInfo &d, const std::string &word) {
  if (word == "all") return true;
  if (word == "gpu") return d.is_gpu;
  if (word == "cpu") return d.is_cpu;
  if (word == "pocl") return is_pocl(d);
  if (word == d.address() || word == std::to_string(d.flat_index)) return true;
  if (word.find_first_not_of("0123456789:") == std::string::npos) return false;
  return lower(d.name + " " + d.platform_name).find(lower(word)) != std::string::npos;
}

/// auto: a GPU with the most compute units, else the first CPU.
std::vector<Found> choose_auto(const std::vector<Found> &all) {
  const auto rank = [](const Found &f) { return (f.info.is_gpu ? 1000000u : 0u) + f.info.compute_units; };
  const auto best = std::max_element(all.begin(), all.end(), [&](auto &a, auto &b) { return rank(a) < rank(b); });
  return {*best};
}

std::vector<Found> choose(const std::vector<Found> &all, const std::string &select) {
  std::vector<Found> chosen;
  std::istringstream words(select);
  for (std::string word; std::getline(words, word, ',');) {
    std::vector<Found> these;
    if (word == "auto") these = choose_auto(all);
    else
      std::copy_if(all.begin(), all.end(), std::back_inserter(these), [&](auto &f) { return matches(f.info, word); });
    if (these.empty()) {
      std::string list;
      for (const Found &f : all) list += "\n  " + f.info.address() + "  " + f.info.name;
      throw DeviceError("no OpenCL device matches '" + word + "'; there are:" + list +
                        "\nanother CPU driver comes with `apt-get install pocl-opencl-icd`, a GPU's from its vendor");
    }
    for (Found &f : these)
      if (std::none_of(chosen.begin(), chosen.end(), [&](auto &c) { return c.info.flat_index == f.info.flat_index; }))
        chosen.push_back(std::move(f));
  }
  return chosen;
}

/// Device fission: the part of a CPU device with `threads` compute units.
cl::Device partition(const Found &f, unsigned threads) {
  if (!f.info.is_cpu) throw DeviceError("--threads applies to CPU devices only, and " + f.info.name + " is none");
  if (threads == 0 || threads > f.info.compute_units)
    throw InputError({"command line", 1, 1}, "--threads " + std::to_string(threads) + ": expected 1 to " +
                                                 std::to_string(f.info.compute_units) + " for " + f.info.name);
  if (threads == f.info.compute_units) return f.device;
  const cl_device_partition_property by_counts[] = {CL_DEVICE_PARTITION_BY_COUNTS,
                                                    static_cast<cl_device_partition_property>(threads),
                                                    CL_DEVICE_PARTITION_BY_COUNTS_LIST_END, 0};
  std::vector<cl::Device> parts;
  cl::Device whole = f.device;
  whole.createSubDevices(by_counts, &parts);
  return parts.front();
}

LanePlan plan_lanes(const DeviceInfo &info, std::optional<int> wanted) {
  LanePlan plan = info.is_gpu ? LanePlan{1, 1, 64} : LanePlan{8, 4, 1};
  if (wanted && *wanted == 1) plan.lanes_float = plan.lanes_double = 1;
  if (wanted && *wanted == 8) plan.lanes_float = 8, plan.lanes_double = 4;
  if (wanted && *wanted == 4) plan.lanes_float = 4, plan.lanes_double = 4;
  return plan;
}

std::shared_ptr<Device> open(const Found &f, const DeviceOptions &options) {
  auto state = std::make_unique<Device::State>();
  state->info = f.info;
  state->options = options;
  try {
    state->device = options.threads ? partition(f, *options.threads) : f.device;
    if (options.threads && *options.threads < f.info.compute_units) {
      state->info.compute_units = *options.threads;
      state->info.has_images = false;  // PoCL 3.1 aborts when an image is written through a sub-device's queue
    }
    state->context = cl::Context(state->device);
    state->queue = cl::CommandQueue(state->context, state->device);
  } catch (const cl::Error &error) {
    throw_failed_call(error, "opening the device", f.info.name);
  }
  state->lanes = plan_lanes(f.info, options.lanes);
  const std::size_t own_limit = f.info.memory_bytes / 4 * 3;
  state->budget_bytes = options.memory_bytes ? std::min(*options.memory_bytes, f.info.memory_bytes) : own_limit;
  return std::make_shared<Device>(std::move(state));
}

}  // namespace

Device::Device(std::unique_ptr<State> state) : state_(std::move(state)) {}
Device::~Device() = default;
const DeviceInfo &Device::info() const { return state_->info; }
const LanePlan &Device::lanes() const { return state_->lanes; }
const DeviceOptions &Device::options() const { return state_->options; }
std::size_t Device::budget_bytes() const { return state_->budget_bytes; }
std::size_t Device::used_bytes() const { return state_->used_bytes; }
double Device::compile_seconds() const { return state_->compile_seconds; }

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> infos;
  for (const Found &f : find_all()) infos.push_back(f.info);
  return infos;
}

static std::string selection(const DeviceOptions &options) {
  if (!options.select.empty()) return options.select;
  const char *from_environment = std::getenv("GREENRAY_DEVICE");
  return from_environment && *from_environment ? from_environment : "pocl";
}

bool asks_for_several(const DeviceOptions &options) {
  const std::string select = selection(options);
  return select == "all" || select.find(',') != std::string::npos;
}

std::vector<std::shared_ptr<Device>> open_devices(const DeviceOptions &options) {
  const std::vector<Found> all = find_all();
  if (all.empty()) throw DeviceError(install_hint);
  const std::string select = selection(options);
  std::vector<std::shared_ptr<Device>> opened;
  for (const Found &f : choose(all, select)) opened.push_back(open(f, options));
  if (opened.empty()) throw DeviceError(install_hint);
  return opened;
}

std::shared_ptr<Device> open_device(const DeviceOptions &options) { return open_devices(options).front(); }

}  // namespace greenray
