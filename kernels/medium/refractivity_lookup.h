/* Reads cells of the index table, for each lane its own (row, cell), from a buffer or from a NEAREST image.
   source: docs/method.md "The table"; G04 asks for a tabulated n, we tabulate d(ln n)/dz, which is what the ray needs.
 */

#if TABLE_IS_IMAGE
#define INDEX_TABLE __read_only image2d_t
__constant sampler_t nearest_texel = CLK_NORMALIZED_COORDS_FALSE | CLK_ADDRESS_CLAMP_TO_EDGE | CLK_FILTER_NEAREST;
#else
#define INDEX_TABLE GLOBAL const IndexCell *
#endif

/* One cell for every lane. */
typedef struct CellLanes {
  real gradient[4];
  real bottom_m, thickness_m, log_index, step_cap_m;
  real density[4];
} CellLanes;

DEVICE IndexCell read_cell(INDEX_TABLE table, int row, int cell, int cells_per_row) {
#if TABLE_IS_IMAGE
  IndexCell c;
  const int x = cell * INDEX_CELL_TEXELS;
  vstore4(read_imagef(table, nearest_texel, (int2)(x, row)), 0, &c.gradient[0]);
  vstore4(read_imagef(table, nearest_texel, (int2)(x + 1, row)), 0, &c.bottom_m);
  vstore4(read_imagef(table, nearest_texel, (int2)(x + 2, row)), 0, &c.density[0]);
  return c;
#else
  return table[row * cells_per_row + cell];
#endif
}

DEVICE void load_cells(INDEX_TABLE table, mask row, mask cell, int cells_per_row, CellLanes *out) {
  for (int i = 0; i < LANES; ++i) {
    const IndexCell c = read_cell(table, (int)LANE_INT(row, i), (int)LANE_INT(cell, i), cells_per_row);
    for (int k = 0; k < 4; ++k) {
      LANE(out->gradient[k], i) = c.gradient[k];
      LANE(out->density[k], i) = c.density[k];
    }
    LANE(out->bottom_m, i) = c.bottom_m;
    LANE(out->thickness_m, i) = c.thickness_m;
    LANE(out->log_index, i) = c.log_index;
    LANE(out->step_cap_m, i) = c.step_cap_m;
  }
}

/* d(ln n)/dz at relative height t of the cell [1/m]. t may leave 0..1 by the landing tolerance. */
DEVICE real log_index_gradient(const CellLanes *c, real t) {
  return c->gradient[0] + t * (c->gradient[1] + t * (c->gradient[2] + t * c->gradient[3]));
}

/* d/dt of the above. */
DEVICE real log_index_gradient_slope(const CellLanes *c, real t) {
  return c->gradient[1] + t * (R(2) * c->gradient[2] + t * (R(3) * c->gradient[3]));
}

/* ln n at t: the integral of the gradient from the bottom of the cell. */
DEVICE real log_index(const CellLanes *c, real t) {
  return c->log_index + c->thickness_m * t *
                            (c->gradient[0] + t * (R(0.5) * c->gradient[1] +
                                                   t * (R(1.0 / 3) * c->gradient[2] + t * R(0.25) * c->gradient[3])));
}

DEVICE real air_density(const CellLanes *c, real t) {
  return c->density[0] + t * (c->density[1] + t * (c->density[2] + t * c->density[3]));
}
