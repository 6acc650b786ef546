// Rays through layers in closed form on a device: all elevations times all wavelengths of a fixed eye.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "atmosphere/layer_table.hpp"
#include "compute/ray_tracer.hpp"

namespace greenray {

class LayerTracer {
 public:
  /// Uploads the layers. between_batches may throw to stop. local_size: of a work-group, 0: the device's own choice; no
  /// bit of a result depends on it, nor on which rays are asked for together. Throws DeviceError if double is asked of
  /// a device without it.
  LayerTracer(std::shared_ptr<Device> device, const LayerTable &table, Precision precision,
              std::function<void()> between_batches = {}, int local_size = 0);
  ~LayerTracer();

  /// One end per elevation [rad] and wavelength, [elevations][wavelengths]. Fields that only a stepping solver has
  /// (steps, cell, rise, solver_error_rad) are 0. above_m is the flattened height of the end.
  std::vector<f64::RayEnd> trace(std::span<const double> elevations_rad);

  /// Where each ray is after each distance [m] along the surface, or where it ended before: [elevations][wavelengths]
  /// [distances]. above_m is the flattened height, rise/run the tangent of the elevation there, columns those up to
  /// there. The table must have no layers merged. A ray in a duct is followed however far (turning_points then counts
  /// one period at most).
  std::vector<f64::RayEnd> places(std::span<const double> elevations_rad, std::span<const double> distances_m);

  const TraceStats &stats() const;

 private:
  template <class Scalar>
  friend class BendBatch;
  struct State;
  std::unique_ptr<State> state_;
};

/// Bending and outcome of a fixed set of elevations, in place: the device reads and writes this memory where it can.
/// Scalar: float or double, the tracer's own precision. The tracer must outlive it.
template <class Scalar>
class BendBatch {
 public:
  BendBatch(LayerTracer &tracer, std::span<const double> elevations_rad);
  ~BendBatch();

  void run();

  /// Of one wavelength, one per elevation [rad]; good until the next run.
  std::span<const Scalar> bending_rad(std::size_t wavelength) const;
  int outcome(std::size_t wavelength, std::size_t elevation) const;  // RayOutcome
  int turning_points(std::size_t wavelength, std::size_t elevation) const;
  double kernel_seconds() const;  // of the last run

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace greenray
