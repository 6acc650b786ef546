/* Marches a bundle of rays, one per lane, cell by cell until each has an outcome.

   A step never leaves its cell: knots and kinks are step ends, so inside a step the medium is one smooth polynomial,
   and a thin layer cannot be leapt over. The distance to the edge of the cell is solved from the ray's own Taylor
   series; a step that lands beyond the edge by more than the landing tolerance is rejected and shortened. Turning
   points are step ends too. */

#if REAL_IS_DOUBLE
#define ROUNDING R(2.3e-16)
#define LANDING R(1e-5) /* of the cell's thickness */
#else
#define ROUNDING R(1.2e-7)
#define LANDING R(1e-4)
#endif

#define SMALLEST (R(1e-6) * LANDING) /* step, of the cell's step cap: taken whatever its error */

#if INTEGRATOR_IS_RICHARDSON
#define INTEGRATOR_STEP richardson_step
#else
#define INTEGRATOR_STEP dormand_prince_step
#endif

typedef struct TraceSettings {
  scalar tolerance_rad; /* local error of direction per step */
  int max_steps;        /* accepted and rejected together */
  int cells_per_row;
} TraceSettings;

typedef struct March {
  Medium medium;
  RayState y;
  mask row, cell, outcome;
  mask heading; /* all bits (1 when scalar): rising */
  mask turning_points, steps, rejected;
  real sigma_m, sigma_end_m, step_m;
  real min_z_m, max_z_m, solver_error_rad;
  real start_momentum2, start_potential; /* for the Bouguer alarm: N^2 and ln N of the table at the start */
#if MEDIUM_VARIES
  mask column, first_column, last_column, first_cell, cells; /* of the row; of the column */
  mask uniform_turns;                                        /* turning points where nothing varies any more */
  mask at_side;
  real width_m;
  real bending_rest_rad, path_rest_m; /* what the sums have lost to rounding */
#endif
} March;

/* How far beyond the edge of the cell ahead: negative inside. */
DEVICE real beyond_edge_m(const CellLanes *c, mask rising, real above_m) {
  return rising ? above_m - c->thickness_m : -above_m;
}

#if MEDIUM_VARIES
DEVICE SectionPoint section_of(const Medium *m, const RayState *y) {
  return section_at(&m->cell, y->above_m / m->cell.thickness_m, y->along_m * m->per_width, m->per_width, m->factor);
}
DEVICE real potential_of(const Medium *m, const RayState *y) {
  const SectionPoint medium = section_of(m, y);
  return log_one_plus(medium.refractivity) + (m->cell.bottom_m + y->above_m) * m->absorbers.earth_curvature_per_m;
}
DEVICE real gradient_change(const Medium *m, const RayState *y) { return section_of(m, y).up_slope; }
#else
/* ln N of the table: ln n + z/R. */
DEVICE real potential(const Medium *m, real above_m) {
  const real t = above_m / m->cell.thickness_m;
  return log_index(&m->cell, t) + (m->cell.bottom_m + above_m) * m->absorbers.earth_curvature_per_m;
}

DEVICE real potential_of(const Medium *m, const RayState *y) { return potential(m, y->above_m); }
/* d2(ln n)/dz dt */
DEVICE real gradient_change(const Medium *m, const RayState *y) {
  return log_index_gradient_slope(&m->cell, y->above_m / m->cell.thickness_m);
}
#endif

/* sigma to the edge ahead, or to the turning point where that comes first.
   z(s) = z + p s + F s^2/2 + J s^3/6: the parabola solved without cancellation, then two Newton steps for the cubic
   term. */
DEVICE real sigma_to_edge(const Medium *m, const RayState *y, const RaySlope *slope, mask rising) {
  const real distance = (rising ? m->cell.thickness_m : SPREAD(0)) - y->above_m;
  const real p = y->rise, force = slope->rise;
  const real discriminant = p * p + R(2) * force * distance;
  const real speed = root(larger(discriminant, SPREAD(0)));
  const real denominator = p + (rising ? speed : -speed);
  real s = R(2) * distance / (denominator != R(0) ? denominator : SPREAD(1));

  const real momentum2 = slope->optical_path_m;
  const real jerk = p * (R(2) * force * force / momentum2 + momentum2 * gradient_change(m, y) / m->cell.thickness_m);
  for (int i = 0; i < 2; ++i) {
    const real miss = distance - s * (p + s * (R(0.5) * force + s * R(1.0 / 6) * jerk));
    const real velocity = p + s * (force + s * R(0.5) * jerk);
    const mask usable = (velocity * denominator > R(0)) & (magnitude(miss) < R(0.5) * magnitude(distance));
    s += usable ? miss / velocity : SPREAD(0);
  }
  const real turn = -p / (force != R(0) ? force : SPREAD(1));
  s = discriminant < R(0) ? turn : s;
  /* A standing ray (denominator 0) is left to the step cap; a turn just ahead is stepped over by a sliver. */
  s = ((denominator == R(0)) & (discriminant >= R(0))) ? m->cell.step_cap_m : s;
  return larger(s, (discriminant < R(0)) ? R(0.01) * m->cell.step_cap_m : SPREAD(0));
}

/* Flattened height [m]. */
DEVICE real height(const March *w) { return w->medium.cell.bottom_m + w->y.above_m; }

#if MEDIUM_VARIES
#include "ray/sides.h"
#else
DEVICE mask is_topmost(const March *w, const TraceSettings *settings) { return w->cell == settings->cells_per_row - 1; }
DEVICE void enter_cells(March *w, INDEX_TABLE table, const TraceSettings *settings) {
  load_cells(table, w->row, w->cell, settings->cells_per_row, &w->medium.cell);
}
#endif

DEVICE void start_march(March *w, INDEX_TABLE table, GLOBAL const RayStart *rays, int first, int last,
                        const TraceSettings *settings, Absorbers absorbers) {
  for (int i = 0; i < LANES; ++i) {
    const RayStart ray = rays[first + i < last ? first + i : last];
    LANE(w->y.above_m, i) = ray.above_m;
    LANE(w->y.rise, i) = ray.rise;
    LANE(w->medium.run, i) = ray.run;
    LANE(w->sigma_end_m, i) = ray.sigma_end_m;
    LANE_INT(w->row, i) = ray.row;
    LANE_INT(w->cell, i) = ray.cell;
  }
  const real zero = SPREAD(0);
  w->medium.absorbers = absorbers;
  w->y.bending_rad = zero;
  w->y.optical_path_m = zero;
#if WITH_COLUMNS
  w->y.column[0] = w->y.column[1] = w->y.column[2] = zero;
#endif
  w->outcome = w->turning_points = w->steps = w->rejected = SPREAD_INT(0);
  w->sigma_m = w->solver_error_rad = zero;
#if MEDIUM_VARIES
  start_beside(w, table, rays, first, last);
#endif
  enter_cells(w, table, settings);
  w->min_z_m = w->max_z_m = height(w);
  w->step_m = w->medium.cell.step_cap_m;
  const RaySlope slope = slope_of(&w->medium, &w->y);
  w->heading = (w->y.rise > R(0)) | ((w->y.rise == R(0)) & (slope.rise >= R(0)));
  w->start_momentum2 = slope.optical_path_m;
  w->start_potential = potential_of(&w->medium, &w->y);
}

/* From within the landing tolerance exactly onto the edge ahead, by the ray's parabola; returns the lanes that are
   there. A ray that turns before the edge, however close, does not reach it: it stays in its cell. */
DEVICE mask move_onto_edge(March *w, mask close, const TraceSettings *settings) {
  const CellLanes *c = &w->medium.cell;
  const RaySlope slope = slope_of(&w->medium, &w->y);
  const real edge = w->heading ? c->thickness_m : SPREAD(0);
  const real distance = edge - w->y.above_m;
  const real speed2 = w->y.rise * w->y.rise + R(2) * slope.rise * distance;
  const real speed = root(larger(speed2, SPREAD(0)));
  const real denominator = w->y.rise + (w->heading ? speed : -speed);
  const real way = R(2) * distance / (denominator != R(0) ? denominator : SPREAD(1));
  const mask beyond = beyond_edge_m(c, w->heading, w->y.above_m) >= R(0);
  /* Beyond the last edge by a step over its turning point, which the parabola may miss by a hair: back to the turn. */
  const mask ends = beyond & (w->heading ? is_topmost(w, settings) : w->cell == 0);
  const mask moves =
      close & ((speed2 > R(0)) | ends) & (denominator != R(0)) & (magnitude(way) < R(0.02) * c->step_cap_m);
  const real h = moves ? way : SPREAD(0);
  advance(&w->y, h, &slope);
  w->y.above_m = moves ? edge : w->y.above_m;
  w->y.rise = (moves & !(speed2 > R(0))) ? SPREAD(0) : w->y.rise; /* level there: not to turn once more */
  w->sigma_m += h;
  return close & (moves | beyond);
}

/* Into the neighbouring cell, or out of the air, for lanes that stand at the edge ahead. */
DEVICE void cross_edges(March *w, INDEX_TABLE table, const TraceSettings *settings, mask running) {
  const CellLanes *c = &w->medium.cell;
  const mask close = running & (beyond_edge_m(c, w->heading, w->y.above_m) >= -LANDING * c->thickness_m);
  if (!any_lane(close)) return;
  const mask at_edge = move_onto_edge(w, close, settings);
  const mask up = at_edge & w->heading, down = at_edge & !w->heading;
  const mask space = up & is_topmost(w, settings), ground = down & (w->cell == 0);
  w->outcome = space ? SPREAD_INT(RAY_SPACE) : ground ? SPREAD_INT(RAY_GROUND) : w->outcome;
  const mask one = SPREAD_INT(1), none = SPREAD_INT(0);
  const mask rises = up & (!space), sinks = down & (!ground);
  if (!any_lane(rises | sinks)) return;
  w->y.above_m -= rises ? c->thickness_m : SPREAD(0);
  w->cell += (rises ? one : none) - (sinks ? one : none);
  enter_cells(w, table, settings);
  w->y.above_m += sinks ? c->thickness_m : SPREAD(0);
}

/* Notes a change of heading; two turning points, one upper and one lower, mean the ray is trapped. */
DEVICE void note_turning_points(March *w, const RaySlope *slope, mask rising_now, mask rising_before) {
  const mask turned = (rising_now & (!rising_before)) | ((!rising_now) & rising_before);
  if (!any_lane(turned)) return;
  const real extreme = height(w) - R(0.5) * w->y.rise * w->y.rise / (slope->rise != R(0) ? slope->rise : SPREAD(1));
  w->min_z_m = turned ? smaller(w->min_z_m, extreme) : w->min_z_m;
  w->max_z_m = turned ? larger(w->max_z_m, extreme) : w->max_z_m;
  w->turning_points += turned ? SPREAD_INT(1) : SPREAD_INT(0);
  /* A ray asked for at a distance goes on to it, trapped or not. */
#if MEDIUM_VARIES
  const mask held = turned_where_nothing_varies(w, turned) >= 2;
#else
  const mask held = w->turning_points >= 2;
#endif
  const mask trapped = (w->outcome == RAY_RUNNING) & held & (w->sigma_end_m >= R(ENDLESS_M));
  w->outcome = trapped ? SPREAD_INT(RAY_TRAPPED) : w->outcome;
}

/* Tries one step of every running lane; keeps it where it is accurate and stays in its cell. */
DEVICE void try_step(March *w, const RaySlope *slope, const TraceSettings *settings, mask running) {
  const Medium *m = &w->medium;
  const real to_edge = sigma_to_edge(m, &w->y, slope, w->heading);
#if MEDIUM_VARIES
  const real to_side = sigma_to_side(w, slope), to_end = sigma_to_distance(w, slope);
#else
  const real to_side = m->cell.step_cap_m, to_end = w->sigma_end_m - w->sigma_m;
#endif
  const real allowed = smaller(smaller(smaller(to_edge, m->cell.step_cap_m), to_side), to_end);
  const real smallest_m = SMALLEST * m->cell.step_cap_m;
  const real h = larger(smaller(w->step_m, allowed), smallest_m);

  real error;
#if MEDIUM_VARIES
  const RayState from = without_sums(&w->y);
  const RayState end = INTEGRATOR_STEP(m, &from, slope, h, &error);
#else
  const RayState end = INTEGRATOR_STEP(m, &w->y, slope, h, &error);
#endif
  const real tolerance = settings->tolerance_rad + R(2) * ROUNDING * magnitude(end.rise);
  const real beyond = beyond_edge_m(&m->cell, w->heading, end.above_m);
  const mask overshot = beyond > R(4) * LANDING * m->cell.thickness_m;
  const mask smallest = h <= R(2) * smallest_m;
  const mask accepted = running & (((error <= tolerance) & !overshot) | smallest);

  /* Next step: fourth root, a little below the classical fifth (or third) so that no power function is needed. */
  const real ratio = root(root(tolerance / (error + R(1e-3) * tolerance)));
  const real grown = h * smaller(larger(R(0.9) * ratio, SPREAD(R(0.2))), SPREAD(R(4)));
  const real covered = beyond_edge_m(&m->cell, w->heading, w->y.above_m);
  const real secant = covered / (covered - beyond);
  const real shortened = h * smaller(larger(secant, SPREAD(R(0.1))), SPREAD(R(0.95)));
  const real kept = larger(grown, h < w->step_m ? w->step_m : SPREAD(0));
  w->step_m = accepted ? kept : (overshot & (error <= tolerance)) ? shortened : grown;

#if MEDIUM_VARIES
  keep_beside(w, &end, accepted);
  w->at_side = accepted & (h >= to_side);
#endif
  w->y.above_m = accepted ? end.above_m : w->y.above_m;
  w->y.rise = accepted ? end.rise : w->y.rise;
#if !MEDIUM_VARIES
  w->y.bending_rad = accepted ? end.bending_rad : w->y.bending_rad;
  w->y.optical_path_m = accepted ? end.optical_path_m : w->y.optical_path_m;
#endif
#if WITH_COLUMNS
  for (int i = 0; i < 3; ++i) w->y.column[i] = accepted ? end.column[i] : w->y.column[i];
#endif
  w->sigma_m += accepted ? h : SPREAD(0);
  w->solver_error_rad += accepted ? error : SPREAD(0);
  w->min_z_m = smaller(w->min_z_m, height(w));
  w->max_z_m = larger(w->max_z_m, height(w));
  w->steps += accepted ? SPREAD_INT(1) : SPREAD_INT(0);
  w->rejected += (running & (!accepted)) ? SPREAD_INT(1) : SPREAD_INT(0);

#if MEDIUM_VARIES
  const mask arrived = accepted & (h >= to_end);
#else
  const mask arrived = accepted & (w->sigma_m >= w->sigma_end_m * (R(1) - R(2) * ROUNDING));
#endif
  const mask broken = running & !(error <= R(1e30));
  w->outcome = broken ? SPREAD_INT(RAY_NOT_FINITE) : arrived ? SPREAD_INT(RAY_IN_FLIGHT) : w->outcome;
}

DEVICE void trace(March *w, INDEX_TABLE table, const TraceSettings *settings) {
  for (int i = 0; i < settings->max_steps; ++i) {
    mask running = w->outcome == RAY_RUNNING;
    if (!any_lane(running)) break;
    const mask rising_before = w->heading;
    w->heading = (w->y.rise > R(0)) | ((w->y.rise == R(0)) & rising_before);
#if MEDIUM_VARIES
    cross_sides(w, table, settings, running);
#endif
    cross_edges(w, table, settings, running);
    const RaySlope slope = slope_of(&w->medium, &w->y);
    note_turning_points(w, &slope, w->heading, rising_before);
    running = w->outcome == RAY_RUNNING;
    try_step(w, &slope, settings, running);
  }
  w->outcome = w->outcome == RAY_RUNNING ? SPREAD_INT(RAY_LIMIT) : w->outcome;
  w->min_z_m = smaller(w->min_z_m, height(w));
  w->max_z_m = larger(w->max_z_m, height(w));
}

/* |ln| change of N^2 against the table's own N^2: it sees every error of height and momentum. */
DEVICE real bouguer_drift(const March *w) {
  const real momentum2 = slope_of(&w->medium, &w->y).optical_path_m;
  const real kept = (momentum2 - w->start_momentum2) / w->start_momentum2;
  const real expected = R(2) * (potential_of(&w->medium, &w->y) - w->start_potential);
  return R(0.5) * magnitude(kept - (exponential(expected) - R(1)));
}

DEVICE void record(const March *w, GLOBAL RayEnd *ends, int first, int last) {
  March v = *w;
  real drift = bouguer_drift(w);
#if MEDIUM_VARIES
  finish_beside(&v);
#endif
  for (int i = 0; i < LANES; ++i) {
    if (first + i > last) continue;
    RayEnd end;
    end.above_m = LANE(v.y.above_m, i);
    end.run = LANE(v.medium.run, i);
    end.rise = LANE(v.y.rise, i);
    end.sigma_m = LANE(v.sigma_m, i);
    end.bending_rad = LANE(v.y.bending_rad, i);
    end.optical_path_m = LANE(v.y.optical_path_m, i);
    for (int k = 0; k < 3; ++k) {
#if WITH_COLUMNS
      end.column[k] = LANE(v.y.column[k], i);
#else
      end.column[k] = 0;
#endif
    }
    end.min_z_m = LANE(v.min_z_m, i);
    end.max_z_m = LANE(v.max_z_m, i);
    end.solver_error_rad = LANE(v.solver_error_rad, i);
    end.bouguer_drift = LANE(drift, i);
    end.cell = (int)LANE_INT(v.cell, i);
    end.outcome = (int)LANE_INT(v.outcome, i);
    end.turning_points = (int)LANE_INT(v.turning_points, i);
    end.steps = (int)LANE_INT(v.steps, i);
    end.rejected = (int)LANE_INT(v.rejected, i);
#if MEDIUM_VARIES
    record_beside(&v, &end, i);
#endif
    ends[first + i] = end;
  }
}
