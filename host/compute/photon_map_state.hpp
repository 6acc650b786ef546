// The OpenCL side of a PhotonMap; included by host/compute only: tracers write their records here.
#pragma once
#include <optional>

#include "compute/buffer.hpp"
#include "compute/photon_map.hpp"

namespace greenray {

/// Layouts of kernels/map/counting_sort.h.
struct SortPlan {
  cl_int photons, chunk, chunks, buckets, row, shift, cells;
};
struct MovedPhoton {
  cl_float place_m[3];
  cl_uint index, normal;
  cl_int cell;
  cl_float power_W[2];
};
struct ChunkOrder {
  cl_uint first_id, first_bounce, last_id, last_bounce;
  cl_int photons, unsorted;
};
struct Filing {
  cl_int filed, unsorted;
};

struct PhotonMap::State {
  State(std::shared_ptr<Device> d, const PhotonMapOptions &o);
  void build(std::size_t count, const Bounds &bounds, double cell_m);

  std::shared_ptr<Device> owner;
  Device::State &device;
  PhotonMapOptions options;
  int stride;  // of the arrays: room and LANES zeros
  Buffer<Photon> records;
  Buffer<float> record_power_W;  // [photons][waves]
  Buffer<MovedPhoton> moved;
  Buffer<cl_uint> order;                 // number of the record; while photons are filed, their cells
  Buffer<float> boxes;                   // of dense cells: kernels/map/blocks.h
  Buffer<float> x_m, y_m, z_m, power_W;  // power_W[waves][stride]
  Buffer<cl_uint> normal;
  std::optional<Buffer<cl_int>> cell_start;
  PhotonGrid grid{};
  std::size_t filed = 0;

 private:
  int cells() const { return grid.cells[0] * grid.cells[1] * grid.cells[2]; }
  SortPlan plan_sort(std::size_t count) const;
  void make_room(const SortPlan &plan);
  void launch(const char *name, std::size_t items);
  cl::Kernel &kernel(const char *name);

  std::map<std::string, cl::Kernel> kernels_;
  std::optional<Buffer<cl_int>> starts_, bucket_start_;
  std::optional<Buffer<ChunkOrder>> chunk_order_;
  Buffer<Filing> filing_;
};

}  // namespace greenray
