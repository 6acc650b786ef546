// Every command: its specification (flags, help) and what it does. One file each in this folder.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "atmosphere/profile_spec.hpp"
#include "cli/arguments.hpp"
#include "compute/device.hpp"
#include "compute/ray_tracer.hpp"

namespace greenray::cli {

struct Command {
  CommandSpec spec;
  std::function<int(const Arguments &)> run;
};

Command devices_command();
Command refraction_command();
Command trace_command();
Command transfer_command();
Command profile_command();
Command render_command();
Command check_command();
Command batch_command();
Command scenes_command();
Command new_command();
Command compare_command();
Command develop_command();
Command sunset_command();
Command eye_command();
Command bench_command();
/// Of all the other commands.
Command manual_command(std::vector<CommandSpec> specs);

/// --device, --threads, --mem, --lanes, --kernel-dir, --show-build.
DeviceOptions device_options(const Arguments &arguments);
Precision precision_of(const Arguments &arguments, Precision otherwise);

/// --azimuth against the direction of x: the profile's azimuth_deg, or 0 (then --azimuth counts from the path itself)
/// [rad].
double azimuth_from_path_rad(const Arguments &arguments, const ProfileSpec &air);
/// One clause for a comment line: which solver serves air that speaks of places x_m, and why.
std::string solver_words(const ProfileSpec &air, bool section);

/// A spec with common flags appended.
CommandSpec with_common(CommandSpec spec);

/// To the file of -o, whole or not at all, or to standard output.
void emit(const Arguments &arguments, const std::string &text);

/// Shortest decimal text that reads back to the same double.
std::string digits(double value);

}  // namespace greenray::cli
