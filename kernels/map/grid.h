/* Which cell a place lies in, and the rows of cells that a ball of space meets. */

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

/* The same for LANES places at once, in cells from the origin. */
DEVICE mask whole_cells(real t) {
  const real held = smaller(larger(t, SPREAD(-BEYOND_CELLS)), SPREAD(BEYOND_CELLS));
  const mask whole = truncated(held);
  return held < as_reals(whole) ? whole - 1 : whole;
}

DEVICE mask cells_along(const PhotonGrid *grid, int axis, real place_m) {
  return whole_cells((place_m - grid->origin_m[axis]) * grid->per_m);
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

/* From .. to, both among them. */
typedef struct Span {
  int low, high;
} Span;

/* A ball among the cells. Lengths and places in cells from the origin. */
typedef struct Ball {
  float centre[3];
  float reach2;      /* square of the radius with what rounding may add to it */
  float per_y_count; /* 1 / rows side by side along y */
  Span y, z;
  int y_count, rows;
  int all_y, all_z; /* wraps around: a row holds photons of every y, z */
} Ball;

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

/* Squared distances between what the ball's radius is compared with may be off by 3e-7 of themselves, and places in
   cells by 2e-7 of themselves. */
DEVICE float ball_reach2(const PhotonGrid *grid, const float *centre, float radius_m) {
  const float radius = radius_m * grid->per_m;
  const float far = scalar_magnitude(centre[0]) + scalar_magnitude(centre[1]) + scalar_magnitude(centre[2]) + radius;
  const float reach = radius + 2e-6f * far;
  return reach * reach;
}

DEVICE Ball ball_around(const PhotonGrid *grid, const float *place_m, float radius_m) {
  const float size = scalar_magnitude(place_m[0]) + scalar_magnitude(place_m[1]) + scalar_magnitude(place_m[2]);
  const float reach_m = radius_m * 1.000002f + (size + radius_m) * 4e-7f;
  Ball ball;
  for (int axis = 0; axis < 3; ++axis) ball.centre[axis] = (place_m[axis] - grid->origin_m[axis]) * grid->per_m;
  ball.reach2 = ball_reach2(grid, ball.centre, radius_m);
  ball.y = cells_between(grid, 1, place_m[1] - reach_m, place_m[1] + reach_m);
  ball.z = cells_between(grid, 2, place_m[2] - reach_m, place_m[2] + reach_m);
  ball.y_count = ball.y.high - ball.y.low + 1;
  ball.rows = ball.y_count * (ball.z.high - ball.z.low + 1);
  ball.per_y_count = 1 / (float)ball.y_count;
  ball.all_y = grid->wrap && ball.y_count >= grid->cells[1];
  ball.all_z = grid->wrap && ball.z.high - ball.z.low + 1 >= grid->cells[2];
  return ball;
}

/* How far the cells of LANES rows are from the centre along y or z. Outermost cells hold what lies outside, too. */
DEVICE real gaps_along(const Ball *ball, const PhotonGrid *grid, int axis, mask cell) {
  const real low = as_reals(cell), centre = SPREAD(ball->centre[axis]);
  real below = low - centre, above = centre - (low + R(1));
  if (axis == 1 ? ball->all_y : ball->all_z) return SPREAD(0);
  if (!grid->wrap) {
    below = cell <= 0 ? SPREAD(0) : below;
    above = cell >= grid->cells[axis] - 1 ? SPREAD(0) : above;
  }
  return larger(larger(below, above), SPREAD(0));
}

/* The cells of LANES rows that the ball meets: low .. high - 1 of all cells, none where they are equal, and the run of
   photons in them, first .. last - 1. */
typedef struct Rows {
  mask low, high;
  mask first, last;
} Rows;

/* Rows `number` and following, of ball->rows. */
DEVICE Rows rows_of_ball(const Ball *ball, const PhotonGrid *grid, GLOBAL const int *cell_start, int number) {
  const mask numbers = LANE_NUMBERS + SPREAD_INT(number);
  mask z = truncated((as_reals(numbers) + R(0.5)) * ball->per_y_count); /* off by one at most */
  z = z * ball->y_count > numbers ? z - 1 : z;
  z = numbers - z * ball->y_count >= ball->y_count ? z + 1 : z;
  const mask y = numbers - z * ball->y_count + ball->y.low;
  z += ball->z.low;
  const real gap_y = gaps_along(ball, grid, 1, y), gap_z = gaps_along(ball, grid, 2, z);
  const real half2 = ball->reach2 - gap_y * gap_y - gap_z * gap_z;
  const real half_chord = half2 <= R(1e30) ? root(larger(half2, SPREAD(0))) : SPREAD(1e30f);
  const real centre = SPREAD(ball->centre[0]);
  const mask row = (filed_cells(grid, 2, z) * grid->cells[1] + filed_cells(grid, 1, y)) * grid->cells[0];
  const mask is_met = (numbers < ball->rows) & (half2 < 0 ? SPREAD_INT(0) : SPREAD_INT(-1));
  Rows rows;
  rows.low = is_met ? row + filed_cells(grid, 0, whole_cells(centre - half_chord)) : SPREAD_INT(0);
  rows.high = is_met ? row + filed_cells(grid, 0, whole_cells(centre + half_chord)) + 1 : SPREAD_INT(0);
  for (int l = 0; l < LANES; ++l) {
    LANE_INT(rows.first, l) = cell_start[LANE_INT(rows.low, l)];
    LANE_INT(rows.last, l) = cell_start[LANE_INT(rows.high, l)];
  }
  return rows;
}
