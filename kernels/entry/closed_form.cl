/* Rays of one eye and many wavelengths through layers in closed form, LANES elevations of one wavelength side by side.
 */
#include "lib/language.h"

#include "shared/layers.h"
#include "shared/ray.h"

#include "ray/closed_form.h"

#include "ray/closed_form_path.h"

#include "ray/closed_form_place.h"

DEVICE LayeredAir air_of_row(__global const Layer *above, __global const Layer *below, __global const FarNode *far,
                             __global const LayerRow *rows, int4 counts, int row) {
  LayeredAir air;
  air.above = above + row * counts.x;
  air.below = below + row * counts.y;
  air.far = far + row * counts.z;
  air.above_count = counts.x;
  air.below_count = counts.y;
  air.far_count = counts.z;
  air.row = rows[row];
  return air;
}

/* Everything a ray tells. */
__kernel void trace_layers(__global const Layer *above, __global const Layer *below, __global const FarNode *far,
                           __global const LayerRow *rows, const int4 counts, __global const scalar *sines,
                           __global const scalar *cosines, __global RayEnd *ends, const int elevations) {
  const int first = (int)get_global_id(0) * LANES, row = (int)get_global_id(1);
  if (first >= elevations) return;
  real sine, cosine;
  for (int i = 0; i < LANES; ++i) {
    const int at = min(first + i, elevations - 1);
    LANE(sine, i) = sines[at];
    LANE(cosine, i) = cosines[at];
  }
  const LayeredAir air = air_of_row(above, below, far, rows, counts, row);
  LayerPath path;
  follow_layers(&path, &air, sine, cosine);
  record_path(&path, rows[row], ends + row, cosine, first, elevations, (int)get_global_size(1));
}

/* Bending and outcome alone: nine bytes in and out a ray. A work-item takes counts.w groups of LANES rays; sines,
   bending and status hold whole groups (stride of them a row). */
__kernel void bend_rays(__global const Layer *above, __global const Layer *below, __global const FarNode *far,
                        __global const LayerRow *rows, const int4 counts, __global const scalar *sines,
                        __global scalar *bending_rad, __global uchar *status, const int groups) {
  const int row = (int)get_global_id(1);
  const LayeredAir air = air_of_row(above, below, far, rows, counts, row);
  const int first = (int)get_global_id(0) * counts.w, last = min(first + counts.w, groups);
  for (int group = first; group < last; ++group) {
    const real sine = load_lanes(sines + group * LANES);
    const real cosine = root(R(1) - sine * sine);
    LayerPath path;
    follow_layers(&path, &air, sine, cosine);
    mask ended;
    const int at = (row * groups + group) * LANES;
    store_lanes(bending_rad + at, bending_and_status(&path, cosine, &ended));
    store_bytes(status + at, ended);
  }
}

#if WITH_COLUMNS
/* Places along rays: LANES distances of one ray side by side. ends: [elevations][wavelengths][distances]. */
__kernel void place_rays(__global const Layer *above, __global const Layer *below, __global const FarNode *far,
                         __global const LayerRow *rows, const int4 counts, __global const scalar *sines,
                         __global const scalar *cosines, __global const scalar *distances_m, __global RayEnd *ends,
                         const int distances) {
  const int first = (int)get_global_id(0) * LANES, row = (int)get_global_id(1), ray = (int)get_global_id(2);
  if (first >= distances) return;
  real distance_m;
  for (int i = 0; i < LANES; ++i) LANE(distance_m, i) = distances_m[min(first + i, distances - 1)];
  const LayeredAir air = air_of_row(above, below, far, rows, counts, row);
  place_rays_at(&air, SPREAD(sines[ray]), SPREAD(cosines[ray]), distance_m,
                ends + (ray * (int)get_global_size(1) + row) * distances + first, 1, distances - first);
}

/* The same for few distances of many rays: LANES rays at one distance side by side. */
__kernel void place_rays_abreast(__global const Layer *above, __global const Layer *below, __global const FarNode *far,
                                 __global const LayerRow *rows, const int4 counts, __global const scalar *sines,
                                 __global const scalar *cosines, __global const scalar *distances_m,
                                 __global RayEnd *ends, const int distances, const int elevations) {
  const int first = (int)get_global_id(0) * LANES, row = (int)get_global_id(1), place = (int)get_global_id(2);
  if (first >= elevations) return;
  real sine, cosine;
  for (int i = 0; i < LANES; ++i) {
    const int at = min(first + i, elevations - 1);
    LANE(sine, i) = sines[at];
    LANE(cosine, i) = cosines[at];
  }
  const LayeredAir air = air_of_row(above, below, far, rows, counts, row);
  const int stride = (int)get_global_size(1) * distances;
  place_rays_at(&air, sine, cosine, SPREAD(distances_m[place]), ends + first * stride + row * distances + place, stride,
                elevations - first);
}
#endif
