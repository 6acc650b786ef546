// Rays through the device in batches that fit its memory; shared by the tracers of layered and of varying air.
#pragma once
#include <algorithm>
#include <chrono>
#include <functional>
#include <span>
#include <vector>

#include "compute/buffer.hpp"
#include "compute/ray_tracer.hpp"

namespace greenray {

inline constexpr std::size_t batch_rays = std::size_t{1} << 18;

inline double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Start, End: as the device holds them. narrow: a start of `all` -> Start. launch(starts, ends, count) runs the
/// kernel; note(end) takes each End, in order.
template <class Start, class End, class Wide, class Narrow, class Launch, class Note>
void trace_in_batches(Device::State &device, std::span<const Wide> all, const std::function<void()> &between_batches,
                      Narrow narrow, Launch launch, Note note) {
  if (all.empty()) return;
  const std::size_t left = device.budget_bytes - std::min(device.budget_bytes, device.used_bytes);
  const std::size_t fitting = std::max<std::size_t>(left / 2 / (sizeof(Start) + sizeof(End)), 64);
  const std::size_t batch = std::min({all.size(), batch_rays, fitting});
  Buffer<Start> starts(device, batch, "rays to trace");
  Buffer<End> ends(device, batch, "traced rays");
  std::vector<Start> host_starts(batch);
  std::vector<End> host_ends(batch);
  for (std::size_t first = 0; first < all.size(); first += batch) {
    if (first > 0 && between_batches) between_batches();
    const std::size_t count = std::min(batch, all.size() - first);
    std::transform(all.begin() + static_cast<std::ptrdiff_t>(first),
                   all.begin() + static_cast<std::ptrdiff_t>(first + count), host_starts.begin(), narrow);
    starts.write(host_starts.data(), count);
    launch(starts, ends, count);
    ends.read(host_ends.data(), count);
    for (std::size_t i = 0; i < count; ++i) note(host_ends[i]);
  }
}

/// Counts an end: outcome, steps, largest errors of rays that left or landed.
template <class End>
void note_end(TraceStats &stats, const End &end) {
  ++stats.rays;
  ++stats.outcomes[static_cast<std::size_t>(end.outcome)];
  stats.steps += static_cast<std::uint64_t>(end.steps);
  stats.rejected += static_cast<std::uint64_t>(end.rejected);
  if (end.outcome == f64::RAY_SPACE || end.outcome == f64::RAY_GROUND) {
    stats.solver_error_rad = std::max(stats.solver_error_rad, static_cast<double>(end.solver_error_rad));
    stats.bouguer_drift = std::max(stats.bouguer_drift, static_cast<double>(end.bouguer_drift));
  }
}

}  // namespace greenray
