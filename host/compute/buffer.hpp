// Device memory that counts against the device's budget and frees itself.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "compute/device_state.hpp"

namespace greenray {

/// Takes `bytes` from the budget while it lives. Throws MemoryError (needs, has, try) when there is not enough.
class Reservation {
 public:
  Reservation(Device::State &device, std::size_t bytes, const std::string &what);
  ~Reservation() { device_->used_bytes -= bytes_; }
  Reservation(const Reservation &) = delete;
  Reservation &operator=(const Reservation &) = delete;

 private:
  Device::State *device_;
  std::size_t bytes_;
};

/// A buffer's elements as the host reads them; no copy where the device shares the host's memory.
template <class T>
class Mapped {
 public:
  Mapped(cl::CommandQueue queue, cl::Buffer buffer, std::size_t count)
      : queue_(std::move(queue)), buffer_(std::move(buffer)), count_(count) {
    data_ = static_cast<T *>(queue_.enqueueMapBuffer(buffer_, CL_TRUE, CL_MAP_READ, 0, count * sizeof(T)));
  }
  ~Mapped() {
    try {
      queue_.enqueueUnmapMemObject(buffer_, data_);
      queue_.finish();
    } catch (const cl::Error &) {  // a device that is gone says so at the next call
    }
  }
  Mapped(const Mapped &) = delete;
  Mapped &operator=(const Mapped &) = delete;
  std::span<const T> values() const { return {data_, count_}; }

 private:
  cl::CommandQueue queue_;
  cl::Buffer buffer_;
  std::size_t count_;
  T *data_ = nullptr;
};

/// A typed buffer. `T` must have the device's own layout.
template <class T>
class Buffer {
 public:
  Buffer(Device::State &device, std::size_t count, const std::string &what)
      : device_(&device), count_(count), what_(what), reservation_(device, count * sizeof(T), what) {
    try {
      buffer_ = cl::Buffer(device.context, CL_MEM_READ_WRITE, count * sizeof(T));
    } catch (const cl::Error &error) {
      throw_failed_call(error, what, device.info.name);
    }
  }

  void write(const T *data, std::size_t count) {
    try {
      device_->queue.enqueueWriteBuffer(buffer_, CL_TRUE, 0, count * sizeof(T), data);
    } catch (const cl::Error &error) {
      throw_failed_call(error, "writing " + what_, device_->info.name);
    }
  }
  void read(T *data, std::size_t count) const {
    try {
      device_->queue.enqueueReadBuffer(buffer_, CL_TRUE, 0, count * sizeof(T), data);
    } catch (const cl::Error &error) {
      throw_failed_call(error, "reading " + what_, device_->info.name);
    }
  }
  Mapped<T> map(std::size_t count) const {
    try {
      return Mapped<T>(device_->queue, buffer_, count);
    } catch (const cl::Error &error) {
      throw_failed_call(error, "mapping " + what_, device_->info.name);
    }
  }
  std::size_t count() const { return count_; }
  const cl::Buffer &cl() const { return buffer_; }

 private:
  Device::State *device_;
  std::size_t count_;
  std::string what_;
  Reservation reservation_;
  cl::Buffer buffer_;
};

}  // namespace greenray
