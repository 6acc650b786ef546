/* The part of the march that only a medium varying along the surface has: columns and their sides.

   Within a column the medium is one smooth polynomial in x, too, so sides are step ends like the edges of cells. A step
   that ends at a side carries what it went beyond it into the next column: no way is lost.

   A ray is proven to be trapped only where nothing varies any more (beyond the last point of the profile, or straight
   across its path): an upper and a lower turning point there. A duct that ends lets its rays go. */

/* The columns of each lane, for its (row, column). */
DEVICE void load_columns(March *w, SectionTable table) {
  for (int i = 0; i < LANES; ++i) {
    const SectionColumn c = table.columns[LANE_INT(w->first_column, i) + LANE_INT(w->column, i)];
    LANE(w->width_m, i) = c.width_m;
    LANE(w->medium.per_width, i) = c.per_width;
    LANE_INT(w->first_cell, i) = c.first_cell;
    LANE_INT(w->cells, i) = c.cells;
  }
}

DEVICE mask is_topmost(const March *w, const TraceSettings *settings) {
  (void)settings;
  return w->cell == w->cells - 1;
}

DEVICE void enter_cells(March *w, SectionTable table, const TraceSettings *settings) {
  (void)settings;
  for (int i = 0; i < LANES; ++i)
    load_section_cell(table, (int)(LANE_INT(w->first_cell, i) + LANE_INT(w->cell, i)), i, &w->medium.cell);
}

DEVICE void start_beside(March *w, SectionTable table, GLOBAL const RayStart *rays, int first, int last) {
  const real zero = SPREAD(0);
  w->y.run_change = w->y.distance_m = w->y.across_m = w->y.drift = zero;
  w->bending_rest_rad = w->path_rest_m = zero;
  w->uniform_turns = w->at_side = SPREAD_INT(0);
  w->medium.sideways = 0;
  for (int i = 0; i < LANES; ++i) {
    const RayStart ray = rays[first + i < last ? first + i : last];
    const SectionRow row = table.rows[ray.row];
    LANE(w->y.along_m, i) = ray.along_m;
    LANE(w->medium.course, i) = ray.course;
    LANE(w->medium.beam, i) = ray.beam;
    LANE(w->medium.factor, i) = row.factor;
    LANE_INT(w->column, i) = ray.column;
    LANE_INT(w->first_column, i) = row.first_column;
    LANE_INT(w->last_column, i) = row.columns - 1;
    w->medium.sideways |= ray.beam != R(0);
  }
  load_columns(w, table);
}

/* dx/dsigma. */
DEVICE mask goes_along(const RaySlope *slope) { return slope->along_m > R(0); }

/* sigma to the side of the column ahead: x(s) = x + v s + a s^2/2, a from the change of run. */
DEVICE real sigma_to_side(const March *w, const RaySlope *slope) {
  const mask along = goes_along(slope);
  const mask open = along ? w->column == w->last_column : w->column == 0;
  const real velocity = slope->along_m;
  const real distance = along ? w->width_m - w->y.along_m : -w->y.along_m;
  const real s = distance / (velocity != R(0) ? velocity : SPREAD(1));
  const real push = slope->run_change * w->medium.course;
  const real corrected = s - R(0.5) * push * s * s / (velocity != R(0) ? velocity : SPREAD(1));
  const mask none = open | (velocity == R(0));
  return none ? SPREAD(R(1e30)) : larger(corrected, SPREAD(0));
}

/* sigma to where the ray is to stop; sigma_end_m is a distance here. */
DEVICE real sigma_to_distance(const March *w, const RaySlope *slope) {
  const mask endless = w->sigma_end_m >= R(ENDLESS_M);
  const real run = slope->distance_m;
  const real left_m = w->sigma_end_m - w->y.distance_m;
  const real s = left_m / larger(run, SPREAD(R(1e-12)));
  const real corrected = s - R(0.5) * slope->run_change * s * s / larger(run, SPREAD(R(1e-12)));
  return endless ? SPREAD(R(1e30)) : larger(corrected, SPREAD(0));
}

/* A ray through a long duct is bent by degrees in a thousand steps: their sums are kept with what rounding takes from
   them (Kahan, Comm. ACM 8 (1965) 40), and a step starts from sums of 0 so that only its own change is added. */
DEVICE RayState without_sums(const RayState *y) {
  RayState from = *y;
  from.bending_rad = from.optical_path_m = SPREAD(0);
  return from;
}
DEVICE void add_to_sum(real *sum, real *rest, real change, mask accepted) {
  const real wanted = change - *rest, reached = *sum + wanted;
  *rest = accepted ? (reached - *sum) - wanted : *rest;
  *sum = accepted ? reached : *sum;
}

DEVICE void keep_beside(March *w, const RayState *end, mask accepted) {
  add_to_sum(&w->y.bending_rad, &w->bending_rest_rad, end->bending_rad, accepted);
  add_to_sum(&w->y.optical_path_m, &w->path_rest_m, end->optical_path_m, accepted);
  w->y.run_change = accepted ? end->run_change : w->y.run_change;
  w->y.along_m = accepted ? end->along_m : w->y.along_m;
  w->y.distance_m = accepted ? end->distance_m : w->y.distance_m;
  w->y.across_m = accepted ? end->across_m : w->y.across_m;
  w->y.drift = accepted ? end->drift : w->y.drift;
}

/* Into the neighbouring column for lanes that stand at its side: the height above the surface stays. */
DEVICE void cross_sides(March *w, SectionTable table, const TraceSettings *settings, mask running) {
  const mask crosses = running & w->at_side;
  if (!any_lane(crosses)) return;
  const RaySlope slope = slope_of(&w->medium, &w->y);
  const mask along = goes_along(&slope);
  const mask one = SPREAD_INT(1), none = SPREAD_INT(0);
  const real old_bottom_m = w->medium.cell.bottom_m, z_m = height(w);
  const mask forward = crosses & along, back = crosses & !along;
  w->y.along_m -= forward ? w->width_m : SPREAD(0);
  w->column += (forward ? one : none) - (back ? one : none);
  load_columns(w, table);
  w->y.along_m += back ? w->width_m : SPREAD(0);
  for (int i = 0; i < LANES; ++i) {
    if (!LANE_INT(crosses, i)) continue;
    const SectionColumn c = table.columns[LANE_INT(w->first_column, i) + LANE_INT(w->column, i)];
    LANE_INT(w->cell, i) = find_section_cell(table, c, LANE(z_m, i));
  }
  enter_cells(w, table, settings);
  w->uniform_turns = crosses ? none : w->uniform_turns;
  w->y.above_m += crosses ? old_bottom_m - w->medium.cell.bottom_m : SPREAD(0);
  w->at_side = none;
}

/* Turning points since the medium last varied, counting those of `turned`. */
DEVICE mask turned_where_nothing_varies(March *w, mask turned) {
  const mask uniform = (w->medium.per_width == R(0)) | ((w->medium.course == R(0)) & (w->y.drift == R(0)));
  const mask one = SPREAD_INT(1), none = SPREAD_INT(0);
  w->uniform_turns = uniform ? w->uniform_turns + (turned ? one : none) : none;
  return w->uniform_turns;
}

/* Run as it is at the end; sigma so that run sigma is the distance; drift as the angle out of the plane of departure.
 */
DEVICE void finish_beside(March *w) {
  w->medium.run += w->y.run_change;
  const real run = w->medium.run, rise = w->y.rise;
  w->sigma_m = w->y.distance_m / (run != R(0) ? run : SPREAD(1));
  const real leaning = rise * w->medium.absorbers.earth_curvature_per_m * w->y.across_m;
  w->y.drift = (w->y.drift + leaning) / root(run * run + rise * rise);
}

DEVICE void record_beside(March *w, RayEnd *end, int lane) {
  end->cell = (int)(LANE_INT(w->first_cell, lane) + LANE_INT(w->cell, lane));
  end->column_number = (int)LANE_INT(w->column, lane);
  end->along_m = LANE(w->y.along_m, lane);
  end->sideways_rad = LANE(w->y.drift, lane);
}
