/* The runs of photons in crowded rows, those that may hold dense cells. They are rare: a gather looks at all other rows
   first, in a loop that knows nothing of dense cells. */

typedef struct Crowd {
  int row; /* of the ball, to be looked at next */
  Rows rows;
  int bits;            /* crowded rows among `rows` that are still to be met */
  int cell, cell_last; /* cells of the row cell .. cell_last - 1 */
  int nearest_first;   /* blocks of a dense cell */
  int in_walk;
  Walk walk;       /* of a dense cell */
  int first, last; /* photons first .. last - 1 */
} Crowd;

DEVICE int is_crowded(int first, int last) { return last - first >= DENSE; }

DEVICE Crowd crowd(int nearest_first) {
  Crowd crowd;
  crowd.nearest_first = nearest_first;
  crowd.row = crowd.bits = crowd.cell = crowd.cell_last = crowd.in_walk = 0;
  return crowd;
}

DEVICE int has_dense_cell(GLOBAL const int *cell_start, int cell, int last) {
  int dense = 0;
  for (; cell < last; ++cell) dense |= cell_start[cell + 1] - cell_start[cell] >= DENSE;
  return dense;
}

/* Turns to the next crowded row; 0 when the ball has no more. */
DEVICE int next_crowded_row(Crowd *crowd, const PhotonArrays *map, const PhotonGrid *grid, const Ball *ball) {
  while (crowd->bits == 0) {
    if (crowd->row >= ball->rows) return 0;
    crowd->rows = rows_of_ball(ball, grid, map->cell_start, crowd->row);
    crowd->row += LANES;
    for (int l = 0; l < LANES; ++l)
      crowd->bits |= is_crowded(LANE_INT(crowd->rows.first, l), LANE_INT(crowd->rows.last, l)) << l;
  }
  const int l = lowest_bit(crowd->bits);
  crowd->bits &= crowd->bits - 1;
  crowd->cell = LANE_INT(crowd->rows.low, l), crowd->cell_last = LANE_INT(crowd->rows.high, l);
  return 1;
}

/* The next run: a whole row, a cell, or a block that comes nearer than the root of limit2. 0 when there is none. */
DEVICE int next_run(Crowd *crowd, const PhotonArrays *map, const PhotonGrid *grid, const Ball *ball, float x, float y,
                    float z, float limit2) {
  for (;;) {
    if (crowd->in_walk) {
      crowd->in_walk = next_block(&crowd->walk, x, y, z, limit2);
      crowd->first = crowd->walk.first, crowd->last = crowd->walk.last;
      if (crowd->in_walk) return 1;
    }
    if (crowd->cell == crowd->cell_last) {
      if (!next_crowded_row(crowd, map, grid, ball)) return 0;
      if (!has_dense_cell(map->cell_start, crowd->cell, crowd->cell_last)) {
        crowd->first = map->cell_start[crowd->cell], crowd->last = map->cell_start[crowd->cell_last];
        crowd->cell = crowd->cell_last;
        return 1;
      }
    }
    crowd->first = map->cell_start[crowd->cell], crowd->last = map->cell_start[++crowd->cell];
    if (crowd->last - crowd->first >= DENSE) {
      start_walk(&crowd->walk, map->boxes, crowd->first, crowd->last, x, y, z, limit2, crowd->nearest_first);
      crowd->in_walk = 1;
    } else if (crowd->first < crowd->last) {
      return 1;
    }
  }
}
