#include "compute/buffer.hpp"

#include "support/error.hpp"

namespace greenray {

static std::string megabytes(std::size_t bytes) { return std::to_string((bytes + 999999) / 1000000) + " MB"; }

Reservation::Reservation(Device::State &device, std::size_t bytes, const std::string &what)
    : device_(&device), bytes_(bytes) {
  const std::size_t left = device.budget_bytes - std::min(device.used_bytes, device.budget_bytes);
  if (bytes > left || bytes > device.info.largest_buffer_bytes)
    throw MemoryError(what + " needs " + megabytes(bytes) + " on " + device.info.name + ", which has " +
                      megabytes(std::min(left, device.info.largest_buffer_bytes)) +
                      " left of its budget: try a larger --mem, or a smaller --size or number of wavelengths");
  device.used_bytes += bytes;
}

}  // namespace greenray
