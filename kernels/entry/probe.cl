/* Known answers and layouts: what a device makes of single functions, structs and random numbers. */
#include "ray/ray.h"

#include "lib/random.h"
#include "shared/probe.h"

__kernel void probe_functions(__global const ProbeInput *inputs, __global ProbeOutput *outputs, const int count,
                              const Absorbers absorbers) {
  const int i = (int)get_global_id(0);
  if (i >= count) return;
  const ProbeInput in = inputs[i];
  outputs[i] = probe(&in, absorbers);
}

#define OFFSET(type, member) ((int)(size_t)(&((__private type *)0)->member))

__kernel void probe_layout(__global int *layout) {
  layout[0] = (int)sizeof(IndexCell);
  layout[1] = (int)sizeof(RayStart);
  layout[2] = (int)sizeof(RayEnd);
  layout[3] = (int)sizeof(Absorbers);
  layout[4] = OFFSET(IndexCell, density);
  layout[5] = OFFSET(RayStart, row);
  layout[6] = OFFSET(RayEnd, column);
  layout[7] = OFFSET(RayEnd, outcome);
}

__kernel void probe_random(__global const uint *keys_and_counters, __global uint *words, const int count) {
  const int i = (int)get_global_id(0);
  if (i >= count) return;
  RandomWords counter;
  for (int k = 0; k < 4; ++k) counter.word[k] = keys_and_counters[6 * i + k];
  const RandomWords r = philox(counter, keys_and_counters[6 * i + 4], keys_and_counters[6 * i + 5]);
  for (int k = 0; k < 4; ++k) words[4 * i + k] = r.word[k];
}
