/* What a device draws, for tests: one sample a work-item. */
#include "lib/language.h"

#include "lib/random.h"
#include "lib/vec3.h"

#include "lib/sampling.h"

#include "lib/sampling_probe.h"

__kernel void probe_sampling(__global float *samples, const int count, const int kind, const float parameter,
                             const uint seed) {
  const int i = (int)get_global_id(0);
  if (i >= count) return;
  const Vec3 s = sample_of_kind(kind, parameter, photon_words(seed, 0, (uint)i, 0, 0));
  samples[3 * i] = s.x;
  samples[3 * i + 1] = s.y;
  samples[3 * i + 2] = s.z;
}
