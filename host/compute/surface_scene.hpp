// A scene's surfaces and medium on a device, ready to be bound to kernels; and paths through them, read back.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "atmosphere/air_table.hpp"
#include "compute/device.hpp"
#include "scene/bvh.hpp"

namespace greenray {

class SurfaceScene {
 public:
  /// The tree must be built for the device's own lanes (lanes_for). longest_sag_m: see AirShape; 0: chosen.
  SurfaceScene(std::shared_ptr<Device> device, const SurfaceTree &tree, const AirTable &air, double longest_sag_m = 0);
  ~SurfaceScene();

  static int lanes_for(const Device &device);
  bool is_curved() const;

  /// Paths to their next surface (kernels/entry/probe_geometry.cl). curved: compile curve code even for a straight
  /// medium.
  std::vector<surface32::PathEnd> trace(std::span<const surface32::PathStart> starts);
  std::vector<surface32::SegmentHit> find(std::span<const surface32::Segment> segments);
  /// The same in parts, for timing: segments to the device, the search alone, and its hits.
  void load(std::span<const surface32::Segment> segments);
  void run_loaded();
  std::vector<surface32::SegmentHit> find_loaded();
  /// Seconds of the last kernel, its transfers left out.
  double kernel_seconds() const;

  struct State;  // OpenCL objects (compute/surface_scene_state.hpp)
  State &state() const { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

}  // namespace greenray
