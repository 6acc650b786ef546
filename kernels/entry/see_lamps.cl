/* One work-item follows camera.samples paths of the eye through one pixel of a list, for the lamps that they meet. */
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

/* pixels: of the camera's band, row by row; lamps[count][WAVES]: mean radiance */
__kernel void see_lamps(GEOMETRY_BUFFERS, AIR_BUFFERS, LOOKS_BUFFERS, __global const int *pixels, __global float *lamps,
                        const EyeCamera camera, const int count) {
  const int i = (int)get_global_id(0);
  if (i >= count) return;
  const Geometry geometry = GEOMETRY_OF_BUFFERS;
  const Air air = AIR_OF_BUFFERS;
  const Looks looks = LOOKS_OF_BUFFERS;
  const int column = camera.first_column + pixels[i] % camera.width;
  const int row = camera.first_row + pixels[i] / camera.width;
  float sum[WAVES];
  for (int w = 0; w < WAVES; ++w) sum[w] = 0;
  for (int sample = 0; sample < camera.samples; ++sample) {
    EyeSample out;
    float seen[WAVES], asked[WAVES];
    follow_eye_path(&geometry, &air, &looks, &camera, column, row, camera.first_sample + sample, &out, seen, asked);
    for (int w = 0; w < WAVES; ++w) sum[w] += seen[w];
  }
  for (int w = 0; w < WAVES; ++w) lamps[i * WAVES + w] = sum[w] / (float)camera.samples;
}
