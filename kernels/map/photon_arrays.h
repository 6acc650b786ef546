/* The map as the gather reads it: one array for each quantity, photons in the order of their cells, LANES zeros behind
   the last one. */

typedef struct PhotonArrays {
  GLOBAL const int *cell_start; /* [cells + 1] */
  GLOBAL const float *boxes;    /* of dense cells: map/blocks.h */
  GLOBAL const float *x_m, *y_m, *z_m;
  GLOBAL const int *normal;
  GLOBAL const float *power_W; /* [waves][stride] */
  int stride;
} PhotonArrays;
