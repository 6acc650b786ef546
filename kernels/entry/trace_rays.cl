/* One work-item traces LANES rays from start to outcome. */
#include "ray/ray.h"

__kernel void trace_rays(INDEX_TABLE table, __global const RayStart *starts, __global RayEnd *ends, const int ray_count,
                         const int cells_per_row, const int max_steps, const scalar tolerance_rad,
                         const Absorbers absorbers) {
  const int first = (int)get_global_id(0) * LANES;
  if (first >= ray_count) return;
  const TraceSettings settings = {tolerance_rad, max_steps, cells_per_row};
  March march;
  start_march(&march, table, starts, first, ray_count - 1, &settings, absorbers);
  trace(&march, table, &settings);
  record(&march, ends, first, ray_count - 1);
}
