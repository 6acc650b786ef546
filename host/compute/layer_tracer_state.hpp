// The device's side of LayerTracer in one precision; included by host/compute only.
#pragma once
#include <chrono>

#include "compute/buffer.hpp"
#include "compute/layer_tracer.hpp"
#include "compute/program.hpp"

namespace greenray {

struct LayerTracer::State {
  State(std::shared_ptr<Device> d, const LayerTable &table, Precision p);

  bool is_double() const { return precision == Precision::double_; }
  std::size_t lanes() const {
    return static_cast<std::size_t>(is_double() ? device.lanes.lanes_double : device.lanes.lanes_float);
  }

  /// A kernel of closed_form.cl with the layers in place, arguments 0 to 4. groups: per work-item.
  cl::Kernel kernel(const char *name, bool with_columns, int groups);

  /// Runs items x wavelengths x rays work-items; seconds until done.
  double launch(cl::Kernel &kernel, std::size_t items, std::size_t rays = 1);

  std::shared_ptr<Device> owner;
  Device::State &device;
  Precision precision;
  std::size_t rows;
  cl_int near_above, layers_below, far_nodes;
  std::size_t local_size;
  bool warm = false;
  std::function<void()> between_batches;
  cl::Buffer above, below, far, row_buffer;
  TraceStats stats;

 private:
  template <class Layer, class Node, class Row>
  void upload(const LayerTable &table);
};

}  // namespace greenray
