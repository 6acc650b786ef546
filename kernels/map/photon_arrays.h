/* The map as the gather reads it: one array for each quantity, photons in the order of their cells, LANES zeros behind
   the last one. */

typedef struct PhotonArrays {
  GLOBAL const int *cell_start; /* [cells + 1] */
  GLOBAL const float *x_m, *y_m, *z_m;
  GLOBAL const int *normal;
  GLOBAL const float *power_W; /* [waves][stride] */
  int stride;
} PhotonArrays;

/* Photons first .. last - 1 of the map, from their records; zeros from `filled` on. */
DEVICE void transpose_photons(GLOBAL const Photon *photons, GLOBAL const float *power_W,
                              GLOBAL const unsigned int *order, GLOBAL float *x_m, GLOBAL float *y_m, GLOBAL float *z_m,
                              GLOBAL unsigned int *normal, GLOBAL float *wave_power_W, int first, int last, int filled,
                              int stride) {
  for (int i = first; i < last; ++i) {
    if (i < filled) {
      const unsigned int index = order[i];
      const Photon photon = photons[index];
      x_m[i] = photon.place_m[0];
      y_m[i] = photon.place_m[1];
      z_m[i] = photon.place_m[2];
      normal[i] = photon.normal;
      for (int w = 0; w < WAVES; ++w) wave_power_W[w * stride + i] = power_W[index * WAVES + w];
    } else {
      x_m[i] = y_m[i] = z_m[i] = 0;
      normal[i] = 0;
      for (int w = 0; w < WAVES; ++w) wave_power_W[w * stride + i] = 0;
    }
  }
}
