// The OpenCL side of a SurfaceScene; included by host/compute only.
#pragma once
#include <optional>
#include <string>

#include "compute/buffer.hpp"
#include "compute/program.hpp"
#include "compute/surface_scene.hpp"

namespace greenray {

struct SurfaceScene::State {
  State(std::shared_ptr<Device> d, const SurfaceTree &tree, const AirTable &air, double longest_sag_m);

  /// Sets the arguments GEOMETRY_BUFFERS. returns: the next free argument
  cl_uint bind_surfaces(cl::Kernel &kernel, cl_uint first) const;
  /// Sets the arguments GEOMETRY_BUFFERS and AIR_BUFFERS. returns: the next free argument
  cl_uint bind(cl::Kernel &kernel, cl_uint first) const;
  /// A program that includes surface/surface.h; words: more " -DNAME=VALUE".
  cl::Program program(const std::string &entry, const std::string &words = "") const;
  /// Runs a kernel over `count` work-items and returns its seconds.
  double launch(cl::Kernel &kernel, const char *name, std::size_t count) const;

  std::shared_ptr<Device> owner;
  Device::State &device;
  int lanes;
  bool curved;
  surface32::GeometryBounds bounds;
  surface32::AirShape shape;
  Buffer<float> boxes, blocks;
  Buffer<int> children, block_ids;
  Buffer<surface32::SurfaceTriangle> triangles;
  Buffer<surface32::SurfaceSphere> spheres;
  Buffer<surface32::AirLayer> layers;
  Buffer<surface32::AirCell> cells;
  std::optional<Buffer<surface32::Segment>> segments;  // loaded
  std::optional<Buffer<surface32::SegmentHit>> segment_hits;
  double kernel_seconds = 0;
};

}  // namespace greenray
