/* Paths to the next surface, read back: for tests and for the benchmark of short segments. */
#include "surface/surface.h"

__kernel void trace_paths(GEOMETRY_BUFFERS, AIR_BUFFERS, __global const PathStart *starts, __global PathEnd *ends,
                          const int count) {
  const int i = (int)get_global_id(0);
  if (i >= count) return;
  const Geometry geometry = GEOMETRY_OF_BUFFERS;
  const Air air = AIR_OF_BUFFERS;
  PathEnd end;
  trace_path(&geometry, &air, starts[i], &end);
  ends[i] = end;
}

/* The nearest surface on a straight piece of given length: a tree search and nothing else. */
__kernel void find_on_segments(GEOMETRY_BUFFERS, __global const Segment *segments, __global SegmentHit *hits,
                               const int count) {
  const int i = (int)get_global_id(0);
  if (i >= count) return;
  const Geometry geometry = GEOMETRY_OF_BUFFERS;
  SegmentHit hit;
  find_on_segment(&geometry, segments[i], &hit);
  hits[i] = hit;
}
