/* Reads cells of the section table, for each lane its own, and evaluates them (shared/section_table.h). */

typedef struct SectionTable {
  GLOBAL const SectionCell *cells;
  GLOBAL const SectionColumn *columns;
  GLOBAL const SectionRow *rows;
} SectionTable;

#define INDEX_TABLE SectionTable

/* One cell for every lane. */
typedef struct CellLanes {
  real slope[16], base[4], density[4];
  real bottom_m, thickness_m, step_cap_m;
} CellLanes;

DEVICE void load_section_cell(SectionTable table, int cell, int lane, CellLanes *out) {
  const SectionCell c = table.cells[cell];
  for (int k = 0; k < 16; ++k) LANE(out->slope[k], lane) = c.slope[k];
  for (int k = 0; k < 4; ++k) {
    LANE(out->base[k], lane) = c.base[k];
    LANE(out->density[k], lane) = c.density[k];
  }
  LANE(out->bottom_m, lane) = c.bottom_m;
  LANE(out->thickness_m, lane) = c.thickness_m;
  LANE(out->step_cap_m, lane) = c.step_cap_m;
}

/* Number within its column of the cell that holds z: the last whose bottom is not above it. */
DEVICE int find_section_cell(SectionTable table, SectionColumn column, scalar z_m) {
  int low = 0, high = column.cells - 1;
  while (low < high) {
    const int middle = (low + high + 1) / 2;
    if (table.cells[column.first_cell + middle].bottom_m <= z_m) low = middle;
    else high = middle - 1;
  }
  return low;
}

/* d(ln n)/dz and d(ln n)/dx [1/m], d2(ln n)/dz dt [1/m]; n - 1 and u. */
typedef struct SectionPoint {
  real up, along, up_slope, refractivity, u;
} SectionPoint;

DEVICE real cubic(const real *c, real s) { return c[0] + s * (c[1] + s * (c[2] + s * c[3])); }
DEVICE real cubic_slope(const real *c, real s) { return c[1] + s * (R(2) * c[2] + s * R(3) * c[3]); }

/* t, s: relative place in the cell; per_width: 1/width of the column; factor: of the wavelength. */
DEVICE SectionPoint section_at(const CellLanes *c, real t, real s, real per_width, real factor) {
  real at[4], change[4]; /* coefficients in t of du/dz, and of their change with s */
  for (int k = 0; k < 4; ++k) {
    at[k] = cubic(&c->slope[4 * k], s);
    change[k] = cubic_slope(&c->slope[4 * k], s);
  }
  const real integral = t * (at[0] + t * (R(0.5) * at[1] + t * (R(1.0 / 3) * at[2] + t * R(0.25) * at[3])));
  const real integral_change =
      t * (change[0] + t * (R(0.5) * change[1] + t * (R(1.0 / 3) * change[2] + t * R(0.25) * change[3])));
  SectionPoint p;
  p.u = cubic(c->base, s) + c->thickness_m * integral;
  p.refractivity = factor * p.u;
  const real log_factor = factor / (R(1) + p.refractivity);
  p.up = log_factor * cubic(at, t);
  p.up_slope = log_factor * cubic_slope(at, t);
  p.along = log_factor * per_width * (cubic_slope(c->base, s) + c->thickness_m * integral_change);
  return p;
}

/* [kg/m^3] */
DEVICE real section_density(const CellLanes *c, real t, real u) { return cubic(c->density, t) * u; }
