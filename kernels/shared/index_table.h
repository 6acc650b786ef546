/* The tabulated n(h, lambda): for each wavelength a row of cells, each cell a cubic of the log-index gradient.

   z is flattened height (medium/height.h): z = R ln(1 + h/R) over a sphere, z = h over a flat surface. Inside a cell,
   with t = (z - bottom_m)/thickness_m in 0..1,   d(ln n)/dz = ((g3 t + g2) t + g1) t + g0   [1/m]. A gradient that
   jumps (a kink of T) is exact: the jump lies between two cells. One cell is three groups of four scalars, so that a
   row is also an image of three RGBA texels per cell: texel 0  gradient[4] [1/m] texel 1  bottom_m, thickness_m,
   log_index (ln n at the bottom), step_cap_m texel 2  density[4]: cubic of the air density in t                [kg/m^3]
   n itself is never stored: in float n - 1 would keep 12 bits. */

#define INDEX_CELL_TEXELS 3
#define INDEX_CELL_SCALARS 12

typedef struct IndexCell {
  scalar gradient[4];
  scalar bottom_m;
  scalar thickness_m;
  scalar log_index;
  scalar step_cap_m;
  scalar density[4];
} IndexCell;
