// Curved rays on a device: a table and settings in, one end per start out.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "atmosphere/index_table.hpp"
#include "compute/device.hpp"
#include "twin/twin.hpp"

namespace greenray {

enum class Precision { single_, double_ };
enum class Integrator { dormand_prince, richardson };
enum class TableStorage { measured, buffer, image };  // measured: both are timed on the device, the faster one is kept

struct TraceOptions {
  Precision precision = Precision::single_;
  Integrator integrator = Integrator::dormand_prince;
  TableStorage storage = TableStorage::measured;
  double tolerance_rad = 1e-9;  // local error of direction per step
  int max_steps = 20000;
  f64::Absorbers absorbers{0, 22000, 5000, 1200};
  bool with_columns = true;
  int local_size = 0;                     // 0: the device's own
  std::function<void()> between_batches;  // may throw to stop
};

/// Outcome counts, indexed by RayOutcome; they sum to the rays launched.
using OutcomeCounts = std::array<std::uint64_t, f64::RAY_OUTCOMES>;
const char *outcome_name(int outcome);  // "space", "ground", ...

struct TraceStats {
  OutcomeCounts outcomes{};
  std::uint64_t rays = 0, steps = 0, rejected = 0;
  double device_seconds = 0;
  double solver_error_rad = 0;  // largest estimate of one ray that left or landed
  double bouguer_drift = 0;     // largest
  void add(const TraceStats &other);
  /// Of the rays traced since then; the largest ones are of all.
  TraceStats since(const TraceStats &then) const;
};

class RayTracer {
 public:
  /// Uploads the table. Throws DeviceError if double is asked of a device without it.
  RayTracer(std::shared_ptr<Device> device, const IndexTable &table, const TraceOptions &options);
  ~RayTracer();

  /// Traces in batches that fit the budget. Results do not depend on batch, local size or storage.
  std::vector<f64::RayEnd> trace(std::span<const f64::RayStart> starts);

  const TraceStats &stats() const;
  bool uses_image() const;
  const Device &device() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace greenray
