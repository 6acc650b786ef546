#include "compute/program.hpp"

#include <chrono>
#include <fstream>
#include <iostream>
#include <sstream>

#include "support/embedded.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

std::string kernel_text(const std::string &path, const std::string &kernel_folder) {
  if (kernel_folder.empty()) {
    const auto text = embedded_file("kernels/" + path);
    if (!text) throw RunError("kernel file kernels/" + path + " is not in this binary: a build is broken");
    return std::string(*text);
  }
  std::ifstream file(kernel_folder + "/" + path);
  if (!file) throw RunError("cannot read kernel file " + kernel_folder + "/" + path + " (--kernel-dir)");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void append_file(std::string &out, const std::string &path, const std::string &kernel_folder, int depth) {
  if (depth > 16) throw RunError("kernel includes nest too deeply at " + path);
  std::istringstream lines(kernel_text(path, kernel_folder));
  int number = 1;
  out += "#line 1 \"kernels/" + path + "\"\n";
  for (std::string line; std::getline(lines, line); ++number) {
    const std::string directive = "#include \"";
    if (line.rfind(directive, 0) != 0) {
      out += line + "\n";
      continue;
    }
    const std::size_t end = line.find('"', directive.size());
    append_file(out, line.substr(directive.size(), end - directive.size()), kernel_folder, depth + 1);
    out += "#line " + std::to_string(number + 1) + " \"kernels/" + path + "\"\n";
  }
}

}  // namespace

std::string build_options(const BuildPlan &plan) {
  return "-cl-std=CL1.2 -DLANES=" + std::to_string(plan.lanes) +
         " -DREAL_IS_DOUBLE=" + (plan.real_is_double ? "1" : "0") +
         " -DTABLE_IS_IMAGE=" + (plan.table_is_image ? "1" : "0") +
         " -DINTEGRATOR_IS_RICHARDSON=" + (plan.richardson ? "1" : "0") +
         " -DWITH_COLUMNS=" + (plan.with_columns ? "1" : "0") + " -DMEDIUM_VARIES=" + (plan.medium_varies ? "1" : "0") +
         (plan.sky_waves ? " -DSKY_WAVES=" + std::to_string(plan.sky_waves) : "") + plan.words;
}

std::string flattened_source(const std::string &entry, const std::string &kernel_folder) {
  std::string text;
  append_file(text, "entry/" + entry + ".cl", kernel_folder, 0);
  return text;
}

cl::Program build_program(Device::State &device, const BuildPlan &plan) {
  const std::string options = build_options(plan), key = plan.entry + " " + options;
  const auto known = device.programs.find(key);
  if (known != device.programs.end()) return known->second;
  if (device.options.show_build) std::cerr << "build    " << plan.entry << ".cl  " << options << "\n";

  const auto begin = std::chrono::steady_clock::now();
  cl::Program program(device.context, flattened_source(plan.entry, device.options.kernel_folder));
  try {
    program.build(device.device, options.c_str());
  } catch (const cl::Error &error) {
    const std::string log = program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device.device);
    throw RunError("building kernels/entry/" + plan.entry + ".cl failed with " + status_name(error.err()) + " on " +
                   device.info.name + " with options " + options + "\n" + log + "\n" +
                   status_remedy(CL_BUILD_PROGRAM_FAILURE));
  }
  if (device.options.show_build) std::cerr << program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device.device);
  device.compile_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return device.programs[key] = program;
}

}  // namespace greenray
