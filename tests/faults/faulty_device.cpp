// Preloaded into greenray by the tests of faults: calls of OpenCL that fail from the N-th on, or once.
//   GREENRAY_FAULT=CALL:N:WHAT   CALL: buffer | build | launch | read | map | write | finish
//                                WHAT: an error number, -4 ..; once -4; or garbage (read: the bytes come back as 0xff)
#include <dlfcn.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <string>

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

namespace {

struct Fault {
  std::string call;
  long from = 0;
  cl_int error = CL_SUCCESS;
  bool once = false, garbage = false;
};

const Fault &wanted() {
  static const Fault fault = [] {
    Fault f;
    const char *text = std::getenv("GREENRAY_FAULT");
    if (text == nullptr) return f;
    const std::string all = text;
    const std::size_t first = all.find(':'), second = all.find(':', first + 1);
    f.call = all.substr(0, first);
    f.from = std::atol(all.substr(first + 1, second - first - 1).c_str());
    std::string what = all.substr(second + 1);
    f.once = what.rfind("once ", 0) == 0;
    if (f.once) what = what.substr(5);
    f.garbage = what == "garbage";
    f.error = std::atoi(what.c_str());
    return f;
  }();
  return fault;
}

/// Is this call of `name` one that goes wrong?
bool strikes(const char *name) {
  static std::atomic<long> count{0};
  const Fault &fault = wanted();
  if (fault.call != name) return false;
  const long number = ++count;
  return fault.once ? number == fault.from : number >= fault.from;
}

template <class Function>
Function *real(const char *name) {
  return reinterpret_cast<Function *>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size, void *host, cl_int *error) {
  if (strikes("buffer")) {
    if (error) *error = wanted().error;
    return nullptr;
  }
  return real<decltype(clCreateBuffer)>("clCreateBuffer")(context, flags, size, host, error);
}

cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id *devices, const char *options,
                      void(CL_CALLBACK *done)(cl_program, void *), void *data) {
  /* The compiler fails by itself then, with a log. */
  const std::string broken = std::string(options ? options : "") + " -D__kernel=wrong";
  if (strikes("build")) options = broken.c_str();
  return real<decltype(clBuildProgram)>("clBuildProgram")(program, count, devices, options, done, data);
}

cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t *offset,
                              const size_t *global, const size_t *local, cl_uint waits, const cl_event *wait,
                              cl_event *event) {
  if (strikes("launch")) return wanted().error;
  return real<decltype(clEnqueueNDRangeKernel)>("clEnqueueNDRangeKernel")(queue, kernel, dimensions, offset, global,
                                                                          local, waits, wait, event);
}

cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset, size_t size,
                           void *to, cl_uint waits, const cl_event *wait, cl_event *event) {
  const bool struck = strikes("read");
  if (struck && !wanted().garbage) return wanted().error;
  const cl_int result = real<decltype(clEnqueueReadBuffer)>("clEnqueueReadBuffer")(queue, buffer, CL_TRUE, offset, size,
                                                                                   to, waits, wait, event);
  (void)blocking;
  if (struck) std::memset(to, 0xff, size);
  return result;
}

cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset, size_t size,
                            const void *from, cl_uint waits, const cl_event *wait, cl_event *event) {
  if (strikes("write")) return wanted().error;
  return real<decltype(clEnqueueWriteBuffer)>("clEnqueueWriteBuffer")(queue, buffer, blocking, offset, size, from,
                                                                      waits, wait, event);
}

void *clEnqueueMapBuffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking, cl_map_flags flags, size_t offset,
                         size_t size, cl_uint waits, const cl_event *wait, cl_event *event, cl_int *error) {
  const bool struck = strikes("map");
  if (struck && !wanted().garbage) {
    if (error) *error = wanted().error;
    return nullptr;
  }
  void *at = real<decltype(clEnqueueMapBuffer)>("clEnqueueMapBuffer")(queue, buffer, blocking, flags, offset, size,
                                                                      waits, wait, event, error);
  if (struck && at != nullptr && (flags & CL_MAP_READ)) std::memset(at, 0xff, size);
  return at;
}

cl_int clFinish(cl_command_queue queue) {
  if (strikes("finish")) return wanted().error;
  return real<decltype(clFinish)>("clFinish")(queue);
}

}  // extern "C"
