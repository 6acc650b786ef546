/* The tabulated section n(h, x, lambda): a texture over height and distance along the surface.

   Columns side by side along x, each a stack of cells over flattened height z (medium/height.h); a cell is bicubic.
   With t = (z - bottom_m)/thickness_m and s = (x - left)/width in 0..1, and u = (n - 1)/factor, factor the spectral
   factor of a wavelength, du/dz = sum over k, j of slope[4 k + j] t^k s^j [1/m] u     = sum over j of base[j] s^j +
   thickness_m * integral of du/dz from 0 to t so that one section serves every wavelength of dry air, and both
   derivatives belong to the same u to the last bit: the field has no curl. Outside the first and the last column
   nothing varies: there s stays 0. A cell is seven groups of four scalars. */

#define SECTION_CELL_SCALARS 28

typedef struct SectionCell {
  scalar slope[16]; /* [power of t][power of s] */
  scalar base[4];
  scalar density[4]; /* cubic in t of the air density over u, in the middle of the column [kg/m^3] */
  scalar bottom_m, thickness_m, step_cap_m, unused;
} SectionCell;

typedef struct SectionColumn {
  scalar width_m, per_width; /* 0 and 0: an end column, open and without change along x */
  int first_cell, cells;
} SectionColumn;

/* Of one wavelength. */
typedef struct SectionRow {
  scalar factor;
  int first_column, columns;
} SectionRow;
