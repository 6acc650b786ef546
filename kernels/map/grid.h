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

/* The rows of cells that a ball meets, and the run of photons of the current one. */
typedef struct Runs {
  float place_m[3];
  float reach_m; /* radius and the rounding of places */
  int low_y, high_y, high_z;
  int y, z;        /* next row */
  int first, last; /* photons first .. last - 1 */
} Runs;

/* Rows low..high along an axis, each once: outside a grid without wrap there is only the outermost one. */
DEVICE void rows_between(const PhotonGrid *grid, int axis, float low_m, float high_m, int *low, int *high) {
  *low = cell_along(grid, axis, low_m);
  *high = cell_along(grid, axis, high_m);
  if (!grid->wrap) {
    *low = clamped_cell(*low, grid->cells[axis]);
    *high = clamped_cell(*high, grid->cells[axis]);
  } else if (*high - *low >= grid->cells[axis]) {
    *high = *low + grid->cells[axis] - 1;
  }
}

DEVICE Runs runs_within(const PhotonGrid *grid, float x, float y, float z, float radius_m) {
  const float size = scalar_magnitude(x) + scalar_magnitude(y) + scalar_magnitude(z) + radius_m;
  Runs runs;
  runs.place_m[0] = x, runs.place_m[1] = y, runs.place_m[2] = z;
  runs.reach_m = radius_m * 1.000002f + size * 4e-7f;
  rows_between(grid, 1, y - runs.reach_m, y + runs.reach_m, &runs.low_y, &runs.high_y);
  rows_between(grid, 2, z - runs.reach_m, z + runs.reach_m, &runs.z, &runs.high_z);
  runs.y = runs.low_y;
  runs.first = runs.last = 0;
  return runs;
}

/* Moves on to the next row with photons near enough along x; 0 when there is none. */
DEVICE int next_run(Runs *runs, const PhotonGrid *grid, GLOBAL const int *cell_start) {
  const int x0 = filed_cell(grid, 0, cell_along(grid, 0, runs->place_m[0] - runs->reach_m));
  const int x1 = filed_cell(grid, 0, cell_along(grid, 0, runs->place_m[0] + runs->reach_m));
  while (runs->z <= runs->high_z) {
    const int row = grid_row(grid, runs->y, runs->z);
    runs->first = cell_start[row + x0];
    runs->last = cell_start[row + x1 + 1];
    if (++runs->y > runs->high_y) runs->y = runs->low_y, ++runs->z;
    if (runs->first < runs->last) return 1;
  }
  return 0;
}
