/* One work-item follows one path of the eye: pixels of a band or of a list, samples fastest. */
#include "surface/surface.h"

#include "lib/random.h"

#include "lib/pack.h"
#include "lib/sampling.h"
#include "shared/light.h"
#include "shared/material.h"
#include "shared/photon.h"

#include "surface/looks.h"

#include "surface/scatter.h"

#include "surface/emit.h"

#include "surface/photon_path.h"

#include "surface/eye_path.h"

/* listed: 1: pixels[] says which of the band, row by row; count: of paths */
__kernel void trace_eye(GEOMETRY_BUFFERS, AIR_BUFFERS, LOOKS_BUFFERS, __global EyeSample *samples,
                        __global float *radiance, __global float *weight, __global const int *pixels,
                        const EyeCamera camera, const int listed, const int count) {
  const int i = (int)get_global_id(0);
  if (i >= count) return;
  const Geometry geometry = GEOMETRY_OF_BUFFERS;
  const Air air = AIR_OF_BUFFERS;
  const Looks looks = LOOKS_OF_BUFFERS;
  const int pixel = listed ? pixels[i / camera.samples] : i / camera.samples;
  const int sample = camera.first_sample + i % camera.samples;
  EyeSample out;
  float seen[WAVES], asked[WAVES];
  follow_eye_path(&geometry, &air, &looks, &camera, camera.first_column + pixel % camera.width,
                  camera.first_row + pixel / camera.width, sample, &out, seen, asked);
  samples[i] = out;
  for (int w = 0; w < WAVES; ++w) {
    radiance[i * WAVES + w] = seen[w];
    weight[i * WAVES + w] = asked[w];
  }
}
