/* Photon records -> the map: keys and counts by chunk, prefix sums, dealing, cells, one array for each quantity. */
#include "lib/language.h"

#include "lib/vec3.h"

#include "lib/pack.h"
#include "shared/photon.h"
#include "shared/photon_grid.h"

#include "map/grid.h"

#include "map/counting_sort.h"
#include "map/photon_arrays.h"

/* chunk_order[chunk]: whether the chunk's photons stand in the order of (id, bounce), and its first and last. */
__kernel void key_photons(__global const Photon *photons, __global KeyedPhoton *pairs, __global int *counts,
                          __global ChunkOrder *chunk_order, const SortPlan plan, const PhotonGrid grid) {
  const int chunk = (int)get_global_id(0);
  if (chunk > 0 && chunk * plan.chunk >= plan.photons) return;
  chunk_order[chunk] = key_chunk(&plan, &grid, photons, pairs, counts + chunk * plan.buckets, chunk);
}

__kernel void scan_counts(__global int *counts, __global int *bucket_start, const int buckets, const int chunks) {
  const int bucket = (int)get_global_id(0);
  if (bucket < buckets) bucket_start[bucket] = scan_chunks(counts, buckets, chunks, bucket);
}

__kernel void scan_totals(__global int *bucket_start, const int buckets) {
  if (get_global_id(0) == 0) scan_buckets(bucket_start, buckets);
}

__kernel void deal_photons(__global const KeyedPhoton *pairs, __global KeyedPhoton *dealt,
                           __global const int *bucket_start, __global int *counts, const SortPlan plan) {
  const int chunk = (int)get_global_id(0);
  if (chunk > 0 && chunk * plan.chunk >= plan.photons) return;
  deal_chunk(&plan, pairs, dealt, bucket_start, counts + chunk * plan.buckets, chunk);
}

__kernel void sort_cells(__global const KeyedPhoton *dealt, __global const int *bucket_start, __global int *cell_start,
                         __global uint *order, const SortPlan plan, const int cells) {
  const int bucket = (int)get_global_id(0);
  if (bucket < plan.buckets) sort_bucket(&plan, cells, dealt, bucket_start, cell_start, order, bucket);
}

__kernel void transpose(__global const Photon *photons, __global const float *power_W, __global const uint *order,
                        __global const int *cell_start, __global float *x_m, __global float *y_m, __global float *z_m,
                        __global uint *normal, __global float *wave_power_W, const int cells, const int chunk,
                        const int stride) {
  const int filled = cell_start[cells], first = (int)get_global_id(0) * chunk;
  if (first >= filled + LANES) return;
  transpose_photons(photons, power_W, order, x_m, y_m, z_m, normal, wave_power_W, first,
                    min(first + chunk, filled + LANES), filled, stride);
}
