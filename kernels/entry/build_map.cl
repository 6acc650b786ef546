/* Photon records -> the map: dealt out by chunk, prefix sums, cells and arrays by bucket. */
#include "lib/language.h"

#include "lib/lane_bits.h"
#include "lib/lanes.h"
#if LANES == 8
#include "lib/transpose.h"
#endif
#include "lib/vec3.h"

#include "lib/pack.h"
#include "shared/photon.h"
#include "shared/photon_grid.h"

#include "map/grid.h"

#include "map/counting_sort.h"

#include "map/blocks.h"

#include "map/order_cell.h"

#include "map/file_bucket.h"

__kernel void deal_photons(__global const Photon *photons, __global const float *power_W, __global int *cells,
                           __global MovedPhoton *moved, __global int *starts, __global ChunkOrder *orders,
                           const SortPlan plan, const PhotonGrid grid) {
  const int chunk = (int)get_global_id(0);
  if (chunk < plan.chunks)
    orders[chunk] = deal_chunk(&plan, &grid, photons, power_W, cells, moved, starts + chunk * plan.row, chunk);
}

/* bucket_start[row]: the photons of each bucket. */
__kernel void total_buckets(__global const int *starts, __global int *bucket_start, const SortPlan plan) {
  const int bucket = (int)get_global_id(0) * LANES;
  if (bucket < plan.buckets) store_ints(bucket_start + bucket, bucket_totals(&plan, starts, bucket));
}

__kernel void scan_buckets(__global const ChunkOrder *orders, __global int *bucket_start, __global Filing *filing,
                           const SortPlan plan) {
  if (get_global_id(0) == 0) *filing = scan_totals(&plan, orders, bucket_start);
}

__kernel void file_photons(__global const Photon *photons, __global const float *power_W,
                           __global const MovedPhoton *moved, __global const int *starts,
                           __global const int *bucket_start, __global const Filing *filing, __global int *cell_start,
                           __global float *boxes, __global float *x_m, __global float *y_m, __global float *z_m,
                           __global uint *normal, __global float *map_power_W, __global uint *order, const int stride,
                           const SortPlan plan, const PhotonGrid grid) {
  const int bucket = (int)get_global_id(0);
  if (bucket >= plan.buckets) return;
  const FiledArrays map = {cell_start, boxes, x_m, y_m, z_m, normal, map_power_W, order, stride};
  const int first = bucket_start[bucket], last = bucket_start[bucket + 1];
  const int fullest = sort_bucket(&plan, moved, starts, first, cell_start, order, bucket);
  if (filing->unsorted) sort_cells_by_emission(&plan, photons, moved, cell_start, order, first, bucket);
  if (fullest >= DENSE) order_dense_cells(&plan, &map, moved, first, bucket);
  write_photons(&map, moved, power_W, first, last);
  if (bucket == plan.buckets - 1) write_zeros(&map, last);
}
