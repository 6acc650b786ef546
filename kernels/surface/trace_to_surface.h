/* A path from a surface, a light or the eye to the next surface, through a medium that bends it. */

DEVICE Vec3 leave_surface(const GeometryBounds *bounds, Vec3 place, Vec3 normal, Vec3 direction) {
  return along(place, dot3(normal, direction) < R(0) ? -bounds->clearance_m : bounds->clearance_m, normal);
}

DEVICE int has_surfaces(const GeometryBounds *b) { return b->triangles + b->spheres > 0; }

/* sigma after which the path is beyond the scene's sides and moves away from it; below 0: it already is. */
DEVICE scalar sigma_in_scene(const GeometryBounds *b, Vec3 place, Vec3 momentum) {
  const scalar x = ((momentum.x < R(0) ? b->low[0] : b->high[0]) - place.x) * safe_inverse(momentum.x);
  const scalar y = ((momentum.y < R(0) ? b->low[1] : b->high[1]) - place.y) * safe_inverse(momentum.y);
  return scalar_smaller(x, y);
}

/* The corners weighed by u and v, a hair inside, so that a path that starts there is on this side of the neighbours. */
DEVICE Vec3 place_in_triangle(GLOBAL const SurfaceTriangle *t, scalar u, scalar v) {
  const scalar hair = R(2e-6);
  u = scalar_larger(u, hair);
  v = scalar_larger(v, hair);
  const scalar beyond = scalar_larger((u + v - (R(1) - hair)) * R(0.5), R(0));
  u -= beyond;
  v -= beyond;
  const Vec3 first = load_vec3(t->corner[0]), second = load_vec3(t->corner[1]), third = load_vec3(t->corner[2]);
  return along(along(first, u, minus(second, first)), v, minus(third, first));
}

DEVICE void put_on_surface(const Geometry *g, SurfaceHit *hit) {
  if (hit->primitive < g->bounds.triangles) {
    GLOBAL const SurfaceTriangle *t = g->triangles + hit->primitive;
    hit->place = place_in_triangle(t, hit->u, hit->v);
    hit->normal = load_vec3(t->normal);
  } else {
    GLOBAL const SurfaceSphere *s = g->spheres + (hit->primitive - g->bounds.triangles);
    hit->normal = unit3(minus(hit->place, load_vec3(s->centre)));
    hit->place = along(load_vec3(s->centre), s->radius_m, hit->normal);
  }
}

/* Looks for a surface on the arc and moves to where it ends. returns: 1 if a surface was met */
DEVICE int follow_arc(const Geometry *g, const Arc *arc, SurfaceHit *hit) {
  Nearest nearest;
  nearest.sigma = arc->end;
  nearest.primitive = NO_PRIMITIVE;
  nearest.u = nearest.v = R(0);
  find_nearest(g, arc, &nearest);
  hit->primitive = nearest.primitive;
  hit->u = nearest.u;
  hit->v = nearest.v;
  hit->place = place_on(arc, nearest.sigma);
  hit->momentum = momentum_on(arc, nearest.sigma);
#if AIR_IS_CURVED
  /* ds = |p| dsigma by Simpson's rule. */
  const scalar middle = length3(momentum_on(arc, R(0.5) * nearest.sigma));
  hit->path_m += nearest.sigma * (length3(arc->momentum) + R(4) * middle + length3(hit->momentum)) * R(1.0 / 6);
#else
  hit->path_m += nearest.sigma * length3(arc->momentum);
#endif
  return nearest.primitive != NO_PRIMITIVE;
}

DEVICE int follow_straight(const Geometry *g, const Path *path, SurfaceHit *hit) {
  Arc arc;
  arc.place = path->place;
  arc.momentum = path->momentum;
  arc.bend = arc.from = R(0);
  arc.end = R(4) *
            (length3(minus(vec3(g->bounds.high[0], g->bounds.high[1], g->bounds.high[2]),
                           vec3(g->bounds.low[0], g->bounds.low[1], g->bounds.low[2]))) +
             length3(minus(path->place, vec3(g->bounds.low[0], g->bounds.low[1], g->bounds.low[2])))) /
            length3(path->momentum);
  return follow_arc(g, &arc, hit) ? PATH_SURFACE : PATH_ESCAPED;
}

#if AIR_IS_CURVED
#define HALF_METRE R(0.5)

/* The cell that holds a height. */
DEVICE int find_air_cell(GLOBAL const AirCell *row, int cells, scalar height_m) {
  int low = 0, high = cells - 1;
  while (low < high) {
    const int middle = (low + high + 1) / 2;
    if (row[middle].bottom_m <= height_m) low = middle;
    else high = middle - 1;
  }
  return low;
}

typedef struct CellExit {
  scalar sigma;
  scalar momentum_z; /* there */
  int step;          /* +1: through the top, -1: through the bottom, 0: never */
} CellExit;

/* When z reaches an edge: rise [m] to the top (>= 0) and to the bottom (<= 0); bend sigma^2 + p sigma = rise. A path
   that turns before one edge leaves by the other. No cancellation: 2 rise/(p + root) where both have the same sign. */
DEVICE CellExit leave_cell(scalar p, scalar bend, scalar to_top, scalar to_bottom) {
  CellExit e;
  const int up = p > R(0) || (p == R(0) && bend > R(0));
  const scalar ahead = up ? to_top : to_bottom, behind = up ? to_bottom : to_top;
  const scalar sign = up ? R(1) : R(-1), speed = sign * p;
  const scalar reaches = speed * speed + R(4) * bend * ahead;
  if (p == R(0) && bend == R(0)) {
    e.sigma = HUGE_BOX_M;
    e.momentum_z = R(0);
    e.step = 0;
  } else if (reaches >= R(0)) {
    const scalar there = scalar_root(reaches), sum = speed + there;
    e.sigma = sum > R(0) ? R(2) * sign * ahead / sum : R(0); /* at rest on the edge, pushed through it */
    e.momentum_z = sign * there;
    e.step = up ? 1 : -1;
  } else {
    const scalar there = scalar_root(speed * speed + R(4) * bend * behind);
    e.sigma = (speed + there) / (R(-2) * sign * bend);
    e.momentum_z = -sign * there;
    e.step = up ? -1 : 1;
  }
  return e;
}

/* Beyond the sides of the scene and moving away, or above (below) it in the endless uppermost (lowest) cell. */
DEVICE int gone_for_good(const GeometryBounds *b, const SurfaceHit *at, int cell, int cells) {
  if (sigma_in_scene(b, at->place, at->momentum) < R(0) || cell < 0 || cell >= cells) return 1;
  return (cell == cells - 1 && at->momentum.z >= R(0) && at->place.z > b->high[2]) ||
         (cell == 0 && at->momentum.z <= R(0) && at->place.z < b->low[2]);
}

/* From cell to cell; `hit` carries place, momentum and length on the way. */
DEVICE int follow_cells(const Geometry *g, const Air *air, const Path *path, SurfaceHit *hit) {
  const int cells = air->shape.cells;
  GLOBAL const AirCell *row = air->cells + path->row * cells;
  int cell = find_air_cell(row, cells, path->place.z);
  for (int i = 0; i < MOST_PATH_CELLS; ++i) {
    if (gone_for_good(&g->bounds, hit, cell, cells)) return PATH_ESCAPED;
    Arc arc;
    arc.place = hit->place;
    arc.momentum = hit->momentum;
    arc.bend = row[cell].bend;
    /* The endless cells end just outside the scene. */
    const scalar top =
        cell < cells - 1 ? row[cell + 1].bottom_m : scalar_larger(arc.place.z, g->bounds.high[2]) + HALF_METRE;
    const scalar bottom = cell > 0 ? row[cell].bottom_m : scalar_smaller(arc.place.z, g->bounds.low[2]) - HALF_METRE;
    const CellExit leaving = leave_cell(arc.momentum.z, arc.bend, top - arc.place.z, bottom - arc.place.z);
    /* Pieces overlap by the rounding of their ends, so that no surface slips through between them. */
    const scalar overlap = g->bounds.dilation_m / length3(arc.momentum);
    scalar end = scalar_smaller(leaving.sigma, sigma_in_scene(&g->bounds, arc.place, arc.momentum) + overlap);
    if (arc.bend != R(0))
      end = scalar_smaller(end, R(2) * scalar_root(air->shape.longest_sag_m / scalar_magnitude(arc.bend)));
    arc.from = i == 0 ? R(0) : -overlap;
    arc.end = end * R(1.000001) + overlap;
    const scalar before = hit->path_m;
    if (follow_arc(g, &arc, hit)) return PATH_SURFACE;
    hit->path_m = before + (hit->path_m - before) * (end / arc.end);
    hit->place = place_on(&arc, end);
    hit->momentum = momentum_on(&arc, end);
    if (end < leaving.sigma) continue;
    hit->place.z = leaving.step > 0 ? top : bottom;
    hit->momentum.z = leaving.momentum_z;
    cell += leaving.step;
  }
  return PATH_LIMIT;
}

#endif

/* n^2 of the medium at a height, for wavelength `row`. */
DEVICE scalar air_index2(const Air *air, int row, scalar height_m) {
#if AIR_IS_CURVED
  GLOBAL const AirCell *cells = air->cells + row * air->shape.cells;
  const AirCell cell = cells[find_air_cell(cells, air->shape.cells, height_m)];
  return cell.index2 + (cell.bend != R(0) ? R(4) * cell.bend * (height_m - cell.bottom_m) : R(0));
#else
  (void)height_m;
  return air->cells[row * air->shape.cells].index2;
#endif
}

/* Follows a path until it meets a surface or is gone.
   returns: PathOutcome; `hit` is whole only for PATH_SURFACE, else place, momentum and path_m say where it was left
   Paths that leave a surface start off it, by leave_surface(). */
DEVICE int trace_to_surface(const Geometry *g, const Air *air, const Path *path, SurfaceHit *hit) {
  hit->place = path->place;
  hit->momentum = path->momentum;
  hit->primitive = NO_PRIMITIVE;
  hit->path_m = R(0);
  hit->transmission = R(1);
  const scalar all =
      path->place.x + path->place.y + path->place.z + path->momentum.x + path->momentum.y + path->momentum.z;
  if (!(all - all == R(0))) return PATH_NOT_FINITE;
  if (!has_surfaces(&g->bounds)) return PATH_ESCAPED;
#if AIR_IS_CURVED
  const int outcome = path->inside_glass ? follow_straight(g, path, hit) : follow_cells(g, air, path, hit);
#else
  const int outcome = follow_straight(g, path, hit);
#endif
  hit->transmission = path->inside_glass ? R(1) : scalar_exponential(-air->shape.extinction_per_m * hit->path_m);
  if (outcome == PATH_SURFACE) put_on_surface(g, hit);
  return outcome;
}
