#include "cli/commands.hpp"

#include <charconv>
#include <iostream>

#include "atmosphere/air_section.hpp"
#include "support/angle.hpp"
#include "support/atomic_file.hpp"

namespace greenray::cli {

DeviceOptions device_options(const Arguments &arguments) {
  DeviceOptions options;
  options.select = arguments.text("--device");
  if (const auto threads = arguments.optional_number("--threads", 1, 65536, ""))
    options.threads = static_cast<unsigned>(*threads);
  if (arguments.has("--mem")) {
    options.memory_bytes = parse_size(arguments.text("--mem"));
    if (!options.memory_bytes) arguments.fail("--mem", "expected a size such as 512M or 6G");
  }
  if (arguments.has("--lanes")) options.lanes = std::stoi(arguments.choice("--lanes", {"1", "4", "8"}, "8"));
  options.kernel_folder = arguments.text("--kernel-dir");
  options.show_build = arguments.has("--show-build");
  return options;
}

Precision precision_of(const Arguments &arguments, Precision otherwise) {
  const std::string word =
      arguments.choice("--precision", {"float", "double"}, otherwise == Precision::double_ ? "double" : "float");
  return word == "double" ? Precision::double_ : Precision::single_;
}

double azimuth_from_path_rad(const Arguments &arguments, const ProfileSpec &air) {
  const auto given_deg = arguments.optional_number("--azimuth", -360, 360, "degrees");
  if (!given_deg) return 0;
  if (!has_places(air))
    arguments.fail("--azimuth", "this air is the same in all directions: expected a profile that varies along x");
  return to_rad(*given_deg - air.azimuth_deg.value_or(0));
}

std::string solver_words(const ProfileSpec &air, bool section) {
  if (!section) return "layers, for nothing varies along the surface";
  return varies_along_surface(air) ? "adaptive, for the air varies along the surface"
                                   : "adaptive, though nothing varies";
}

CommandSpec with_common(CommandSpec spec) {
  for (Flag &flag : common_flags()) spec.flags.push_back(std::move(flag));
  return spec;
}

void emit(const Arguments &arguments, const std::string &text) {
  if (arguments.has("--output")) {
    write_file_atomically(arguments.text("--output"), text);
    return;
  }
  std::cout << text << std::flush;
  if (!std::cout) throw RunError("cannot write to standard output");
}

std::string digits(double value) {
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return std::string(text, end);
}

}  // namespace greenray::cli
