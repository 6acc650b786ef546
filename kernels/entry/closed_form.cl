/* One work-item takes LANES elevations of one wavelength through all layers, up and down from the eye. */
#include "lib/language.h"

#include "shared/layers.h"
#include "shared/ray.h"

#include "ray/closed_form.h"

#include "ray/closed_form_path.h"

__kernel void trace_layers(__global const Layer *above, __global const Layer *below, __global const LayerRow *rows,
                           __global const scalar *sines, __global const scalar *cosines, __global RayEnd *ends,
                           const int elevations, const int layers_above, const int layers_below) {
  const int first = (int)get_global_id(0) * LANES, row = (int)get_global_id(1);
  if (first >= elevations) return;
  real sine, cosine;
  for (int i = 0; i < LANES; ++i) {
    const int at = min(first + i, elevations - 1);
    LANE(sine, i) = sines[at];
    LANE(cosine, i) = cosines[at];
  }
  LayerPath path;
  follow_layers(&path, above + row * layers_above, layers_above, below + row * layers_below, layers_below, rows[row],
                sine, cosine);
  record_path(&path, rows[row], ends + row, cosine, first, elevations, (int)get_global_size(1));
}
