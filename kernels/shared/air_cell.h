/* A flat stratified medium for paths among surfaces: n^2 by height. With ds = n dsigma the equation of rays is
   d2r/dsigma2 = grad(n^2)/2: horizontal momentum is constant and only the height is accelerated, by (d n^2/dz)/2.

   Layers lie between the medium's kinks and are cut into cells of even thickness, in each of which n^2 is a cubic with
   the medium's values and slopes at both edges. The lowest and the highest layer are constant and reach to -HUGE and
   +HUGE. Rows of cells, one row a wavelength; all rows share the layers. */

typedef struct AirCell {
  scalar index2[4]; /* n^2 = sum of index2[k] t^k, t = 0..1 from the cell's bottom to its top */
} AirCell;

typedef struct AirLayer {
  scalar bottom_m; /* the top is the next layer's bottom */
  scalar cells_per_m;
  int first, cells; /* in each row; one cell at least */
  scalar
      steep_step; /* longest sigma of an arc of momentum p_z is steep_step / |p_z|^(1/4), but at most level_step [m] */
  scalar level_step;
  int linear; /* 1: so nearly linear n^2 that a parabola is exact */
  int pad_;
} AirLayer;

typedef struct AirShape {
  int layers;
  int cells;               /* of a row */
  scalar extinction_per_m; /* of power along the path: absorbed, not scattered */
  scalar longest_sag_m; /* chains of arcs are cut so that they differ from their chords by about as much (speed only) */
} AirShape;
