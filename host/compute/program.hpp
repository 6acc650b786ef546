// Kernel sources -> built programs. Sources come from the binary, or from --kernel-dir while they are being edited.
#pragma once
#include <string>

#include "compute/device_state.hpp"

namespace greenray {

/// What is compiled in: one function decides, and --show-build prints it.
struct BuildPlan {
  std::string entry;  // "trace_rays" for kernels/entry/trace_rays.cl
  int lanes = 1;
  bool real_is_double = false;
  bool table_is_image = false;
  bool richardson = false;
  bool with_columns = true;
  bool medium_varies = false;  // along the surface
  int sky_waves = 0;           // shade_sky: wavelengths, padded to whole groups of lanes
  std::string words = {};      // " -DNAME=VALUE" of one entry alone
};

std::string build_options(const BuildPlan &plan);

/// One text with every #include "..." replaced by the file, and #line marks, so that build logs name kernel file and
/// line.
std::string flattened_source(const std::string &entry, const std::string &kernel_folder);

/// Cached by (options, entry). Throws RunError with the build log.
cl::Program build_program(Device::State &device, const BuildPlan &plan);

}  // namespace greenray
