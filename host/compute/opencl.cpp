#include "compute/opencl.hpp"

#include <map>

#include "support/error.hpp"

namespace greenray {

std::string status_name(cl_int status) {
#define NAME(code) \
  { code, #code }
  static const std::map<cl_int, const char *> names{NAME(CL_SUCCESS),
                                                    NAME(CL_DEVICE_NOT_FOUND),
                                                    NAME(CL_DEVICE_NOT_AVAILABLE),
                                                    NAME(CL_COMPILER_NOT_AVAILABLE),
                                                    NAME(CL_MEM_OBJECT_ALLOCATION_FAILURE),
                                                    NAME(CL_OUT_OF_RESOURCES),
                                                    NAME(CL_OUT_OF_HOST_MEMORY),
                                                    NAME(CL_PROFILING_INFO_NOT_AVAILABLE),
                                                    NAME(CL_IMAGE_FORMAT_NOT_SUPPORTED),
                                                    NAME(CL_BUILD_PROGRAM_FAILURE),
                                                    NAME(CL_DEVICE_PARTITION_FAILED),
                                                    NAME(CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST),
                                                    NAME(CL_INVALID_VALUE),
                                                    NAME(CL_INVALID_DEVICE),
                                                    NAME(CL_INVALID_CONTEXT),
                                                    NAME(CL_INVALID_COMMAND_QUEUE),
                                                    NAME(CL_INVALID_HOST_PTR),
                                                    NAME(CL_INVALID_MEM_OBJECT),
                                                    NAME(CL_INVALID_IMAGE_FORMAT_DESCRIPTOR),
                                                    NAME(CL_INVALID_IMAGE_SIZE),
                                                    NAME(CL_INVALID_BUILD_OPTIONS),
                                                    NAME(CL_INVALID_PROGRAM),
                                                    NAME(CL_INVALID_PROGRAM_EXECUTABLE),
                                                    NAME(CL_INVALID_KERNEL_NAME),
                                                    NAME(CL_INVALID_KERNEL),
                                                    NAME(CL_INVALID_ARG_INDEX),
                                                    NAME(CL_INVALID_ARG_VALUE),
                                                    NAME(CL_INVALID_ARG_SIZE),
                                                    NAME(CL_INVALID_KERNEL_ARGS),
                                                    NAME(CL_INVALID_WORK_DIMENSION),
                                                    NAME(CL_INVALID_WORK_GROUP_SIZE),
                                                    NAME(CL_INVALID_WORK_ITEM_SIZE),
                                                    NAME(CL_INVALID_GLOBAL_OFFSET),
                                                    NAME(CL_INVALID_EVENT),
                                                    NAME(CL_INVALID_OPERATION),
                                                    NAME(CL_INVALID_BUFFER_SIZE),
                                                    NAME(CL_INVALID_GLOBAL_WORK_SIZE),
                                                    NAME(CL_INVALID_IMAGE_DESCRIPTOR),
                                                    NAME(CL_INVALID_COMPILER_OPTIONS),
                                                    NAME(CL_INVALID_DEVICE_PARTITION_COUNT)};
#undef NAME
  if (status == -1001) return "CL_PLATFORM_NOT_FOUND_KHR";
  const auto found = names.find(status);
  return found == names.end() ? "OpenCL status " + std::to_string(status) : found->second;
}

std::string status_remedy(cl_int status) {
  switch (status) {
    case CL_MEM_OBJECT_ALLOCATION_FAILURE:
    case CL_OUT_OF_HOST_MEMORY:
      return "try a smaller --mem, --size or --spp";
    case CL_OUT_OF_RESOURCES:
      return "try a smaller --mem, or another --device";
    case CL_BUILD_PROGRAM_FAILURE:
      return "try --device pocl; if it fails there too, please report the log above";
    case CL_DEVICE_NOT_AVAILABLE:
    case CL_INVALID_DEVICE:
      return "see `greenray devices`, and try another --device";
    case CL_DEVICE_PARTITION_FAILED:
    case CL_INVALID_DEVICE_PARTITION_COUNT:
      return "leave out --threads, or give fewer";
    case -1001:
      return "install an OpenCL driver: apt-get install pocl-opencl-icd";
    default:
      return "";
  }
}

void throw_failed_call(const cl::Error &error, const std::string &subject, const std::string &device) {
  const std::string remedy = status_remedy(error.err());
  const std::string message = std::string(error.what()) + " failed with " + status_name(error.err()) + " (" + subject +
                              ", device " + device + ")" + (remedy.empty() ? "" : ": " + remedy);
  if (error.err() == CL_MEM_OBJECT_ALLOCATION_FAILURE || error.err() == CL_OUT_OF_HOST_MEMORY)
    throw MemoryError(message);
  throw RunError(message);
}

}  // namespace greenray
