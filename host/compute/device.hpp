// OpenCL devices: listing, choice by --device, what fits them, their memory budget. No cl_ type shows here.
#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace greenray {

/// What `greenray devices` prints of one device.
struct DeviceInfo {
  int platform = 0, index = 0;  // "platform:index"
  int flat_index = 0;           // counted over all platforms
  std::string name, platform_name, driver, version;
  bool is_cpu = false, is_gpu = false, has_double = false, has_images = false;
  unsigned compute_units = 0;
  std::size_t memory_bytes = 0, largest_buffer_bytes = 0, image_width_max = 0, image_height_max = 0;
  std::string address() const { return std::to_string(platform) + ":" + std::to_string(index); }
};

/// How work is cut for a device: 8 floats or 4 doubles side by side on CPUs, one lane on GPUs.
struct LanePlan {
  int lanes_float = 1, lanes_double = 1;
  int local_size = 1;
};

struct DeviceOptions {
  std::string select;                       // "pocl" (default), auto, all, gpu, cpu, N, P:N, part of a name; comma list
  std::optional<unsigned> threads;          // CPU devices: device fission into N compute units
  std::optional<std::size_t> memory_bytes;  // --mem; default three quarters of what the device says
  std::optional<int> lanes;                 // overrides LanePlan: 1, 4 or 8
  std::string kernel_folder;                // read kernels from disk instead of from the binary
  bool show_build = false;                  // print build options and logs to stderr
};

class Device {
 public:
  ~Device();
  const DeviceInfo &info() const;
  const LanePlan &lanes() const;
  const DeviceOptions &options() const;
  /// Memory this process allows itself on the device, and what it holds now.
  std::size_t budget_bytes() const;
  std::size_t used_bytes() const;
  /// Seconds spent building programs and in first launches, reported apart from the work.
  double compile_seconds() const;

  struct State;  // OpenCL objects, known to host/compute only
  State &state() const { return *state_; }
  explicit Device(std::unique_ptr<State> state);

 private:
  std::unique_ptr<State> state_;
};

/// Every device of every platform. Empty when no driver is installed.
std::vector<DeviceInfo> list_devices();

/// Opens the devices that `options.select` names (GREENRAY_DEVICE, then "pocl", when empty), in that order.
/// Throws DeviceError (exit 3) with an install hint when nothing fits; InputError is never thrown here.
std::vector<std::shared_ptr<Device>> open_devices(const DeviceOptions &options);

/// Is `select` (or GREENRAY_DEVICE, when it is empty) a list, or has it the word "all"?
bool asks_for_several(const DeviceOptions &options);

/// The first of open_devices.
std::shared_ptr<Device> open_device(const DeviceOptions &options);

/// Makes sure that PoCL has a kernel cache it can write to: it aborts the process otherwise. Called by list/open.
/// Sets POCL_CACHE_DIR to a folder under the temporary folder when HOME is unset or the cache is not writable.
void guard_pocl_cache();

}  // namespace greenray
