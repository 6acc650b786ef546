// One picture, as `render` and `batch` make it.
#pragma once
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
  const std::shared_ptr<Device> &device(const Arguments &arguments) {
    static std::mutex one_at_a_time;  // of opening: PoCL's first steps are not for two threads
    const std::lock_guard<std::mutex> guard(one_at_a_time);
    if (!device_) device_ = open_device(device_options(arguments));
    return device_;
  }
  SkySightCache &sights() { return sights_; }

 private:
  std::shared_ptr<Device> device_;
  SkySightCache sights_;
};

/// `greenray render`: arguments of its own specification. Throws as it exits. returns: 0
int render_picture(const Arguments &arguments, Session &session);

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
