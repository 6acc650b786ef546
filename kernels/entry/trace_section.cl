/* One work-item traces LANES rays through air that varies along the surface, from start to outcome. */
#include "ray/ray.h"

__kernel void trace_section(__global const SectionCell *cells, __global const RayStart *starts, __global RayEnd *ends,
                            const int ray_count, const int unused, const int max_steps, const scalar tolerance_rad,
                            const Absorbers absorbers, __global const SectionColumn *columns,
                            __global const SectionRow *rows) {
  const int first = (int)get_global_id(0) * LANES;
  if (first >= ray_count) return;
  const TraceSettings settings = {tolerance_rad, max_steps, unused};
  const SectionTable table = {cells, columns, rows};
  March march;
  start_march(&march, table, starts, first, ray_count - 1, &settings, absorbers);
  trace(&march, table, &settings);
  record(&march, ends, first, ray_count - 1);
}
