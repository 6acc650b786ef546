// The one place that includes OpenCL-CLHPP; only host/compute includes this file.
#pragma once
#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#define CL_TARGET_OPENCL_VERSION 120
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wignored-attributes"
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
#include <CL/opencl.hpp>
#pragma GCC diagnostic pop

#include <string>

namespace greenray {

/// Name of an OpenCL status code ("CL_OUT_OF_RESOURCES").
std::string status_name(cl_int status);

/// What a user can try for that code, one sentence, or "".
std::string status_remedy(cl_int status);

/// Turns a failed call into our errors: which call, which code by name, on what, where, what to try.
/// Throws MemoryError for allocation failures, RunError otherwise.
[[noreturn]] void throw_failed_call(const cl::Error &error, const std::string &subject, const std::string &device);

}  // namespace greenray
