// PoCL calls abort() when it cannot write its kernel cache. We look first.
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "compute/device.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;

/// Can we create the folder and a file in it?
bool writable(const fs::path &folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) return false;
  std::string probe = (folder / "greenray-probe-XXXXXX").string();
  const int file = mkstemp(probe.data());
  if (file < 0) return false;
  const bool wrote = write(file, "x", 1) == 1;
  close(file);
  unlink(probe.c_str());
  return wrote;
}

const char *variable(const char *name) {
  const char *value = std::getenv(name);
  return value && *value ? value : nullptr;
}

fs::path where_pocl_will_write() {
  if (const char *own = variable("POCL_CACHE_DIR")) return own;
  if (const char *xdg = variable("XDG_CACHE_HOME")) return fs::path(xdg) / "pocl" / "kcache";
  if (const char *home = variable("HOME")) return fs::path(home) / ".cache" / "pocl" / "kcache";
  return {};
}

}  // namespace

void guard_pocl_cache() {
  static bool done = false;
  if (done) return;
  done = true;
  if (!variable("PATH"))
    setenv("PATH", "/usr/local/bin:/usr/bin:/bin", 1);  // PoCL aborts when it cannot find its linker
  const fs::path usual = where_pocl_will_write();
  if (!usual.empty() && writable(usual)) return;
  const char *temporary = variable("TMPDIR");
  const fs::path ours = fs::path(temporary ? temporary : "/tmp") / ("greenray-pocl-" + std::to_string(getuid()));
  if (!writable(ours))
    throw DeviceError("PoCL needs a folder for compiled kernels and neither " +
                      (usual.empty() ? std::string("$HOME/.cache") : usual.string()) + " nor " + ours.string() +
                      " can be written: set POCL_CACHE_DIR to a folder that can");
  setenv("POCL_CACHE_DIR", ours.c_str(), 1);
}

}  // namespace greenray
