// Rays through layers in closed form on a device: all elevations times all wavelengths of a fixed eye.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "atmosphere/layer_table.hpp"
#include "compute/ray_tracer.hpp"

namespace greenray {

class LayerTracer {
 public:
  /// between_batches may throw to stop.
  /// with_columns false: bending, outcome and turning points only, everything else stays 0.
  LayerTracer(std::shared_ptr<Device> device, const LayerTable &table, Precision precision,
              std::function<void()> between_batches = {}, bool with_columns = true);
  ~LayerTracer();

  /// One end per elevation [rad] and wavelength, [elevations][wavelengths]. Fields that only a stepping solver has
  /// (steps, cell, rise, solver_error_rad) are 0. above_m is the flattened height of the end.
  std::vector<f64::RayEnd> trace(std::span<const double> elevations_rad);

  const TraceStats &stats() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace greenray
