// One picture, as `render` and `batch` make it.
#pragma once
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "render/sky_sight.hpp"

namespace greenray::cli {

/// What pictures made one after the other share.
class Session {
 public:
  /// The device that the first picture asked for, with its kernels.
  const std::shared_ptr<Device> &device(const Arguments &arguments) { return devices(arguments).front(); }
  /// Those of `--device all` or of a list; else that one alone.
  const std::vector<std::shared_ptr<Device>> &devices(const Arguments &arguments) {
    static std::mutex one_at_a_time;  // of opening: PoCL's first steps are not for two threads
    const std::lock_guard<std::mutex> guard(one_at_a_time);
    if (!devices_.empty()) return devices_;
    const DeviceOptions options = device_options(arguments);
    if (asks_for_several(options)) devices_ = open_devices(options);
    else devices_ = {open_device(options)};
    return devices_;
  }
  SkySightCache &sights() { return sights_; }

 private:
  std::vector<std::shared_ptr<Device>> devices_;
  SkySightCache sights_;
};

/// `greenray render`: arguments of its own specification. Throws as it exits. returns: 0
int render_picture(const Arguments &arguments, Session &session);

/// Puts the parts of a sky picture together; a: the words of `render` that the parts were made with, and the output.
void merge_sky_parts(const Arguments &arguments, const std::vector<std::filesystem::path> &parts, Session &session);

/* Everything that the bits of a picture depend on, but for the device: scene hash, flags that change pictures, version.
   It stands in the picture's JSON as `key`, so that `batch` can tell what is done. errors: InputError, as render's */
std::string picture_key(const Arguments &arguments);

/// Whether OUT.html is written beside the picture.
bool wants_report(const Arguments &arguments);

/// The command line of `render` with these arguments, quoted for a shell.
std::string command_line(const Arguments &arguments);

/// Of `render`.
std::vector<Flag> render_flags();

}  // namespace greenray::cli
