/* A flat stratified medium in which n^2 is linear in height within each cell, for paths among surfaces: there a path is
   a parabola. With ds = n dsigma,  d2r/dsigma2 = grad(n^2)/2.

   Rows of cells, one row a wavelength; all rows have the same heights. The lowest and the highest cell have bend 0 and
   reach to -HUGE and +HUGE: the medium goes on unchanged outside the table. */

typedef struct AirCell {
  scalar bottom_m; /* the top is the next cell's bottom */
  scalar bend;     /* (d n^2/dz)/4 [1/m]: z = z0 + p_z sigma + bend sigma^2 */
  scalar index2;   /* n^2 at the bottom; at the top of the table's lowest cell, which has no bottom */
  scalar pad_;
} AirCell;

typedef struct AirShape {
  int cells;               /* of a row; 1: the same n everywhere */
  scalar extinction_per_m; /* of power along the path: absorbed, not scattered */
  scalar longest_sag_m;    /* arcs are cut so that they differ from their chords by no more (speed only) */
  int pad_;
} AirShape;
