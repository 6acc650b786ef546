/* Which cell a place lies in, and the runs of photons that a ball of space meets. */

#define BEYOND_CELLS 1e9f

/* Number of the cell along one axis, before clamping or wrapping. Monotone in the place, so that a ball between two
   places lies between their cells whatever the rounding. */
DEVICE int cell_along(const PhotonGrid *grid, int axis, float place_m) {
  const float t = (place_m - grid->origin_m[axis]) * grid->per_m;
  if (!(t > -BEYOND_CELLS)) return (int)-BEYOND_CELLS; /* also where t is not a number */
  if (t > BEYOND_CELLS) return (int)BEYOND_CELLS;
  const int truncated = (int)t;
  return truncated - (t < (float)truncated);
}

DEVICE int clamped_cell(int cell, int cells) { return cell < 0 ? 0 : cell < cells ? cell : cells - 1; }

DEVICE int filed_cell(const PhotonGrid *grid, int axis, int cell) {
  return grid->wrap && axis ? cell & (grid->cells[axis] - 1) : clamped_cell(cell, grid->cells[axis]);
}

DEVICE int grid_row(const PhotonGrid *grid, int y, int z) {
  return (filed_cell(grid, 2, z) * grid->cells[1] + filed_cell(grid, 1, y)) * grid->cells[0];
}

DEVICE int grid_cells(const PhotonGrid *grid) { return grid->cells[0] * grid->cells[1] * grid->cells[2]; }

/* The same for LANES places at once. */
DEVICE mask cells_along(const PhotonGrid *grid, int axis, real place_m) {
  const real t = (place_m - grid->origin_m[axis]) * grid->per_m;
  const real held = smaller(larger(t, SPREAD(-BEYOND_CELLS)), SPREAD(BEYOND_CELLS));
  const mask whole = truncated(held);
  return held < as_reals(whole) ? whole - 1 : whole;
}

DEVICE mask filed_cells(const PhotonGrid *grid, int axis, mask cell) {
  if (grid->wrap && axis) return cell & (grid->cells[axis] - 1);
  const mask above = cell < 0 ? SPREAD_INT(0) : cell, most = SPREAD_INT(grid->cells[axis] - 1);
  return above < most ? above : most;
}

DEVICE mask cells_of(const PhotonGrid *grid, real x, real y, real z) {
  return (filed_cells(grid, 2, cells_along(grid, 2, z)) * grid->cells[1] +
          filed_cells(grid, 1, cells_along(grid, 1, y))) *
             grid->cells[0] +
         filed_cells(grid, 0, cells_along(grid, 0, x));
}

/* A cell with DENSE photons or more is filed by SUB x SUB x SUB sub-cells, x fastest, without which a caustic would be
   one long list. sub_start[first photon of the cell + sub-cell] is where each begins, and behind the last one the end:
   DENSE numbers, which have room where the photons of the cell have theirs. */
#define SUB 8
#define DENSE (SUB * SUB * SUB + 1)

/* Sub-cell along one axis within its cell; outside of a grid without wrap the outermost one. Monotone, as the cell. */
DEVICE int sub_along(const PhotonGrid *grid, int axis, float place_m) {
  const float t = (place_m - grid->origin_m[axis]) * grid->per_m;
  const int wraps = grid->wrap && axis, cell = cell_along(grid, axis, place_m);
  if (!wraps && cell < 0) return 0;
  if (!wraps && cell >= grid->cells[axis]) return SUB - 1;
  const float part = (t - (float)cell) * SUB;
  return part > 0 ? part < SUB ? (int)part : SUB - 1 : 0;
}

DEVICE int sub_cell_of(const PhotonGrid *grid, float x, float y, float z) {
  return (sub_along(grid, 2, z) * SUB + sub_along(grid, 1, y)) * SUB + sub_along(grid, 0, x);
}

/* From .. to, both among them. */
typedef struct Span {
  int low, high;
} Span;

/* The rows of cells that a ball meets, and the run of photons of the current one. */
typedef struct Runs {
  float place_m[3];
  float reach_m; /* radius and the rounding of places */
  Span x, y, z;  /* cells */
  int y_next, z_next;
  int first, last; /* photons first .. last - 1 */
  /* Within a row that is met cell by cell, since there are dense ones in it: */
  int in_row;
  int row, row_y, row_z, x_next;
  int dense; /* first photon of a dense cell whose sub-cells are being met; -1: there is none */
  Span sub_x, sub_y;
  int sub_y_next, sub_z_next, sub_z_high;
} Runs;

DEVICE int meets_all_rows(const PhotonGrid *grid, int axis, int low, int high) {
  return grid->wrap && axis && high - low >= grid->cells[axis];
}

/* Cells along an axis, each once: outside a grid without wrap there is only the outermost one. */
DEVICE Span cells_between(const PhotonGrid *grid, int axis, float low_m, float high_m) {
  Span span = {cell_along(grid, axis, low_m), cell_along(grid, axis, high_m)};
  if (!grid->wrap || axis == 0) {
    span.low = clamped_cell(span.low, grid->cells[axis]);
    span.high = clamped_cell(span.high, grid->cells[axis]);
  } else if (meets_all_rows(grid, axis, span.low, span.high)) {
    span.high = span.low + grid->cells[axis] - 1;
  }
  return span;
}

DEVICE Runs runs_within(const PhotonGrid *grid, float x, float y, float z, float radius_m) {
  const float size = scalar_magnitude(x) + scalar_magnitude(y) + scalar_magnitude(z) + radius_m;
  Runs runs;
  runs.place_m[0] = x, runs.place_m[1] = y, runs.place_m[2] = z;
  runs.reach_m = radius_m * 1.000002f + size * 4e-7f;
  runs.x = cells_between(grid, 0, x - runs.reach_m, x + runs.reach_m);
  runs.y = cells_between(grid, 1, y - runs.reach_m, y + runs.reach_m);
  runs.z = cells_between(grid, 2, z - runs.reach_m, z + runs.reach_m);
  runs.y_next = runs.y.low, runs.z_next = runs.z.low;
  runs.in_row = 0;
  runs.dense = -1;
  runs.first = runs.last = 0;
  return runs;
}

/* Sub-cells of a cell along an axis. A ball that meets all rows may meet one from both sides: all of its sub-cells. */
DEVICE Span sub_cells_between(const Runs *runs, const PhotonGrid *grid, int axis, const Span *cells, int cell) {
  const float low_m = runs->place_m[axis] - runs->reach_m, high_m = runs->place_m[axis] + runs->reach_m;
  Span span = {0, SUB - 1};
  if (meets_all_rows(grid, axis, cell_along(grid, axis, low_m), cell_along(grid, axis, high_m))) return span;
  if (cell == cells->low) span.low = sub_along(grid, axis, low_m);
  if (cell == cells->high) span.high = sub_along(grid, axis, high_m);
  return span;
}

DEVICE void enter_dense_cell(Runs *runs, const PhotonGrid *grid, int x) {
  const Span sub_z = sub_cells_between(runs, grid, 2, &runs->z, runs->row_z);
  runs->sub_x = sub_cells_between(runs, grid, 0, &runs->x, x);
  runs->sub_y = sub_cells_between(runs, grid, 1, &runs->y, runs->row_y);
  runs->sub_y_next = runs->sub_y.low;
  runs->sub_z_next = sub_z.low, runs->sub_z_high = sub_z.high;
  runs->dense = runs->first;
}

/* The next row of sub-cells; 0 when the cell has no more. */
DEVICE int next_sub_run(Runs *runs, GLOBAL const int *sub_start) {
  while (runs->sub_z_next <= runs->sub_z_high) {
    const int row = runs->dense + (runs->sub_z_next * SUB + runs->sub_y_next) * SUB;
    runs->first = sub_start[row + runs->sub_x.low];
    runs->last = sub_start[row + runs->sub_x.high + 1];
    if (++runs->sub_y_next > runs->sub_y.high) runs->sub_y_next = runs->sub_y.low, ++runs->sub_z_next;
    if (runs->first < runs->last) return 1;
  }
  runs->dense = -1;
  return 0;
}

/* The next cell of the row, or the next row of its sub-cells; 0 when the row has no more. */
DEVICE int next_cell_run(Runs *runs, const PhotonGrid *grid, GLOBAL const int *cell_start,
                         GLOBAL const int *sub_start) {
  if (runs->dense >= 0 && next_sub_run(runs, sub_start)) return 1;
  while (runs->x_next <= runs->x.high) {
    const int x = runs->x_next++;
    runs->first = cell_start[runs->row + x];
    runs->last = cell_start[runs->row + x + 1];
    if (runs->last - runs->first >= DENSE) {
      enter_dense_cell(runs, grid, x);
      if (next_sub_run(runs, sub_start)) return 1;
    } else if (runs->first < runs->last) {
      return 1;
    }
  }
  runs->in_row = 0;
  return 0;
}

DEVICE int has_dense_cell(const Runs *runs, GLOBAL const int *cell_start, int row) {
  int dense = 0;
  for (int x = runs->x.low; x <= runs->x.high; ++x) dense |= cell_start[row + x + 1] - cell_start[row + x] >= DENSE;
  return dense;
}

/* Moves on to the next row with photons near enough along x; 0 when there is none. */
DEVICE int next_run(Runs *runs, const PhotonGrid *grid, GLOBAL const int *cell_start, GLOBAL const int *sub_start) {
  for (;;) {
    if (runs->in_row && next_cell_run(runs, grid, cell_start, sub_start)) return 1;
    if (runs->z_next > runs->z.high) return 0;
    const int y = runs->y_next, z = runs->z_next, row = grid_row(grid, y, z);
    runs->first = cell_start[row + runs->x.low];
    runs->last = cell_start[row + runs->x.high + 1];
    if (++runs->y_next > runs->y.high) runs->y_next = runs->y.low, ++runs->z_next;
    if (runs->last - runs->first >= DENSE && has_dense_cell(runs, cell_start, row)) {
      runs->in_row = 1;
      runs->row = row, runs->row_y = y, runs->row_z = z, runs->x_next = runs->x.low;
    } else if (runs->first < runs->last) {
      return 1;
    }
  }
}
