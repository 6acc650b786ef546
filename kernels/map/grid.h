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

/* The cells low..high that a ball meets along an axis, and the sub-cells of the outer two. */
typedef struct Span {
  int low, high;
  int low_sub, high_sub;
} Span;

/* The rows of cells that a ball meets, and the run of photons of the current one. */
typedef struct Runs {
  Span x, y, z;
  int row_y, row_z; /* next row */
  int cell_x;       /* next cell of a row with dense cells in it; beyond x.high: there is none */
  int row;          /* of that cell */
  int dense;        /* first photon of a dense cell; -1: not within one */
  int sub_y, sub_z; /* next row of sub-cells */
  Span sub;         /* sub-cells along x and y, from low to high and from low_sub to high_sub */
  int high_sub_z;
  int first, last; /* photons first .. last - 1 */
} Runs;

/* Each cell once: outside a grid without wrap there is only the outermost one; where all rows are met there are no
   outer ones. */
DEVICE Span span_along(const PhotonGrid *grid, int axis, float low_m, float high_m) {
  Span span = {cell_along(grid, axis, low_m), cell_along(grid, axis, high_m), sub_along(grid, axis, low_m),
               sub_along(grid, axis, high_m)};
  if (!grid->wrap || axis == 0) {
    span.low = clamped_cell(span.low, grid->cells[axis]);
    span.high = clamped_cell(span.high, grid->cells[axis]);
  } else if (span.high - span.low >= grid->cells[axis]) {
    span.high = span.low + grid->cells[axis] - 1;
    span.low_sub = 0, span.high_sub = SUB - 1;
  }
  return span;
}

DEVICE Runs runs_within(const PhotonGrid *grid, float x, float y, float z, float radius_m) {
  const float size = scalar_magnitude(x) + scalar_magnitude(y) + scalar_magnitude(z) + radius_m;
  const float reach_m = radius_m * 1.000002f + size * 4e-7f; /* and the rounding of places */
  Runs runs;
  runs.x = span_along(grid, 0, x - reach_m, x + reach_m);
  runs.y = span_along(grid, 1, y - reach_m, y + reach_m);
  runs.z = span_along(grid, 2, z - reach_m, z + reach_m);
  runs.row_y = runs.y.low, runs.row_z = runs.z.low;
  runs.cell_x = runs.x.high + 1;
  runs.dense = -1;
  runs.first = runs.last = 0;
  return runs;
}

DEVICE int sub_low(const Span *span, int cell) { return cell == span->low ? span->low_sub : 0; }
DEVICE int sub_high(const Span *span, int cell) { return cell == span->high ? span->high_sub : SUB - 1; }

/* The row that was left behind last, cell by cell. y, z: of that row. */
DEVICE void enter_cell(Runs *runs, int first, int y, int z) {
  const Span sub = {sub_low(&runs->x, runs->cell_x), sub_high(&runs->x, runs->cell_x), sub_low(&runs->y, y),
                    sub_high(&runs->y, y)};
  runs->sub = sub;
  runs->sub_y = sub.low_sub;
  runs->sub_z = sub_low(&runs->z, z);
  runs->high_sub_z = sub_high(&runs->z, z);
  runs->dense = first;
}

/* The next row of sub-cells; 0 when the cell has no more. */
DEVICE int next_sub_run(Runs *runs, GLOBAL const int *sub_start) {
  while (runs->sub_z <= runs->high_sub_z) {
    const int row = runs->dense + (runs->sub_z * SUB + runs->sub_y) * SUB;
    runs->first = sub_start[row + runs->sub.low];
    runs->last = sub_start[row + runs->sub.high + 1];
    if (++runs->sub_y > runs->sub.high_sub) runs->sub_y = runs->sub.low_sub, ++runs->sub_z;
    if (runs->first < runs->last) return 1;
  }
  runs->dense = -1;
  return 0;
}

/* Within a row that has a dense cell, maybe: the next cell's run; 0 when the row has no more. */
DEVICE int next_cell_run(Runs *runs, GLOBAL const int *cell_start, GLOBAL const int *sub_start) {
  if (runs->dense >= 0 && next_sub_run(runs, sub_start)) return 1;
  while (runs->cell_x <= runs->x.high) {
    /* row_y and row_z have moved on already */
    const int last_of_z = runs->row_y == runs->y.low;
    const int y = last_of_z ? runs->y.high : runs->row_y - 1, z = last_of_z ? runs->row_z - 1 : runs->row_z;
    runs->first = cell_start[runs->row + runs->cell_x];
    runs->last = cell_start[runs->row + runs->cell_x + 1];
    const int is_dense = runs->last - runs->first >= DENSE;
    if (is_dense) enter_cell(runs, runs->first, y, z);
    ++runs->cell_x;
    if (is_dense ? next_sub_run(runs, sub_start) : runs->first < runs->last) return 1;
  }
  return 0;
}

/* Moves on to the next row with photons near enough along x; 0 when there is none. */
DEVICE int next_run(Runs *runs, const PhotonGrid *grid, GLOBAL const int *cell_start, GLOBAL const int *sub_start) {
  for (;;) {
    if (runs->cell_x <= runs->x.high || runs->dense >= 0)
      if (next_cell_run(runs, cell_start, sub_start)) return 1;
    if (runs->row_z > runs->z.high) return 0;
    runs->row = grid_row(grid, runs->row_y, runs->row_z);
    runs->first = cell_start[runs->row + runs->x.low];
    runs->last = cell_start[runs->row + runs->x.high + 1];
    if (++runs->row_y > runs->y.high) runs->row_y = runs->y.low, ++runs->row_z;
    if (runs->last - runs->first >= DENSE) runs->cell_x = runs->x.low;
    else if (runs->first < runs->last) return 1;
  }
}
