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

#if AIR_IS_CURVED
/* ds = |p| dsigma along the first `part` of an arc by Gauss's rule of two points. */
DEVICE scalar arc_length(const Arc *arc, scalar part) {
  const Vec3 first = momentum_on(arc, R(0.211324865405187) * part),
             second = momentum_on(arc, R(0.788675134594813) * part);
  return R(0.5) * part * (length3(first) + length3(second));
}
#endif

/* Looks for a surface on the chain. returns: 1 if one was met; else hit is where the chain ends */
DEVICE int follow_chain(const Geometry *g, const Chain *chain, int measured, SurfaceHit *hit) {
  Nearest nearest = nothing_before(chain->end);
  find_nearest(g, chain, &nearest);
  const int is_met = nearest.primitive != NO_PRIMITIVE, number = is_met ? nearest.arc : chain->arcs - 1;
  const Arc *arc = &chain->arc[number];
  const scalar part = is_met ? nearest.along : arc->end;
  hit->primitive = nearest.primitive;
  hit->u = nearest.u;
  hit->v = nearest.v;
  hit->place = place_on(arc, part);
  hit->momentum = momentum_on(arc, part);
#if AIR_IS_CURVED
  if (measured) {
    for (int i = 0; i < number; ++i)
      hit->path_m += arc_length(&chain->arc[i], chain->arc[i + 1].start - chain->arc[i].start);
    hit->path_m += arc_length(arc, part);
  }
  const scalar t = part / arc->end;
  hit->momentum.z += arc->lag * (R(1) - R(6) * t * (R(1) - t));
#else
  (void)measured;
  hit->path_m += part * length3(arc->momentum);
#endif
  return is_met;
}

DEVICE int follow_straight(const Geometry *g, const Path *path, SurfaceHit *hit) {
  Chain chain;
  Arc *arc = &chain.arc[0];
  arc->place = path->place;
  arc->momentum = path->momentum;
  arc->bend = arc->lag = arc->start = arc->from = R(0);
  arc->end = R(4) *
             (length3(minus(vec3(g->bounds.high[0], g->bounds.high[1], g->bounds.high[2]),
                            vec3(g->bounds.low[0], g->bounds.low[1], g->bounds.low[2]))) +
              length3(minus(path->place, vec3(g->bounds.low[0], g->bounds.low[1], g->bounds.low[2])))) /
             length3(path->momentum);
  chain.arcs = 1;
  chain.from = R(0);
  chain.end = arc->end;
  return follow_chain(g, &chain, 1, hit) ? PATH_SURFACE : PATH_ESCAPED;
}

#if AIR_IS_CURVED
#define HALF_METRE R(0.5)

/* A path on its way through the layers. */
typedef struct Way {
  Climb climb;
  AirSlab slab;
  int row, layer;
  int stalls; /* edges reached one after the other without moving */
  int arcs;   /* so far */
} Way;

DEVICE void enter_layer(const Air *air, int layer, Way *way) {
  way->layer = layer;
  if (layer < 0 || layer >= air->shape.layers) return;
  way->slab = air_slab(air, way->row, layer);
  way->climb.lift = lift_at(&way->slab, way->climb.z);
}

/* Above (below) the scene in the endless uppermost (lowest) layer, or beyond it, for good. */
DEVICE int gone_for_good(const GeometryBounds *b, const Air *air, const Way *way) {
  const int layers = air->shape.layers;
  if (way->layer < 0 || way->layer >= layers) return 1;
  return (way->layer == layers - 1 && way->climb.p >= R(0) && way->climb.z > b->high[2]) ||
         (way->layer == 0 && way->climb.p <= R(0) && way->climb.z < b->low[2]);
}

/* Adds the next arc, `most` long at most. */
DEVICE void add_arc(const Geometry *g, const Air *air, Vec3 place, Vec3 momentum, scalar start, scalar most, Way *way,
                    Chain *chain) {
  /* The endless layers end just outside the scene. */
  const scalar z = way->climb.z, p = way->climb.p,
               top = way->layer < air->shape.layers - 1 ? way->slab.top_m
                                                        : scalar_larger(z, g->bounds.high[2]) + HALF_METRE;
  const scalar bottom = way->layer > 0 ? way->slab.layer.bottom_m : scalar_smaller(z, g->bounds.low[2]) - HALF_METRE;
  Arc *arc = &chain->arc[chain->arcs];
  arc->start = start;
  arc->place = vec3(place.x + start * momentum.x, place.y + start * momentum.y, z);
  arc->momentum = momentum;
  int step = 0;
  if (way->stalls < 2) {
    const Rise r = next_rise(&way->slab, bottom, top, most, way->climb);
    way->climb = r.end;
    step = r.step;
    arc->end = r.sigma;
    arc->momentum.z = r.rise;
    arc->bend = r.bend;
  } else { /* caught on the edge of two layers that both bend towards it: along it */
    arc->end = scalar_smaller(most, way->slab.layer.level_step);
    arc->momentum.z = arc->bend = way->climb.p = R(0);
  }
  arc->lag = p - arc->momentum.z;
  ++way->arcs;
  way->stalls = step != 0 && !(arc->end > R(0)) ? way->stalls + 1 : 0;
  if (arc->end > R(0)) ++chain->arcs;
  if (step != 0) enter_layer(air, way->layer + step, way);
}

/* The path's next arcs from `place`, up to where it leaves the scene, or until they are so bent that a search for all
   of them would look in too many places. returns: 1 if the path goes on behind them */
DEVICE int next_chain(const Geometry *g, const Air *air, Vec3 place, Vec3 momentum, Way *way, Chain *chain) {
  const scalar overlap = g->bounds.dilation_m / length3(momentum);
  const scalar span = sigma_in_scene(&g->bounds, place, momentum) + overlap;
  scalar start = R(0);
  int goes_on = 1;
  chain->arcs = 0;
  chain->from = way->arcs == 0 ? R(0) : -overlap;
  while (chain->arcs < CHAIN_ARCS && way->arcs < MOST_PATH_ARCS) {
    if (start >= span || gone_for_good(&g->bounds, air, way)) {
      goes_on = 0;
      break;
    }
    const int before = chain->arcs;
    add_arc(g, air, place, momentum, start, span - start, way, chain);
    if (chain->arcs == before) continue;
    start += chain->arc[before].end;
    const scalar off = way->climb.z - place.z - momentum.z * start;
    if (scalar_magnitude(off) > R(4) * air->shape.longest_sag_m) break;
  }
  /* Arcs overlap by the rounding of their ends, so that no surface slips through between them. */
  for (int i = 0; i < chain->arcs; ++i) {
    chain->arc[i].from = i == 0 ? chain->from : -overlap;
    chain->arc[i].end = chain->arc[i].end * R(1.000001) + overlap;
  }
  chain->length = start;
  chain->end = start * R(1.000001) + overlap;
  return goes_on;
}

/* From chain to chain. */
DEVICE int follow_curve(const Geometry *g, const Air *air, const Path *path, SurfaceHit *hit) {
  Way way;
  way.climb.z = path->place.z;
  way.climb.p = path->momentum.z;
  way.row = path->row;
  way.stalls = way.arcs = 0;
  enter_layer(air, find_air_layer(air, path->place.z), &way);
  const int measured = path->measured || air->shape.extinction_per_m != R(0);
  Vec3 place = path->place, momentum = path->momentum;
  while (way.arcs < MOST_PATH_ARCS) {
    Chain chain;
    const int goes_on = next_chain(g, air, place, momentum, &way, &chain);
    if (chain.arcs > 0 && follow_chain(g, &chain, measured, hit)) return PATH_SURFACE;
    if (!goes_on) return PATH_ESCAPED;
    if (chain.arcs == 0) continue;
    place = along(place, chain.length, momentum);
    place.z = way.climb.z;
    momentum.z = way.climb.p;
  }
  return PATH_LIMIT;
}

#endif

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
  const int outcome = path->glass ? follow_straight(g, path, hit) : follow_curve(g, air, path, hit);
#else
  const int outcome = follow_straight(g, path, hit);
#endif
  hit->transmission = path->glass ? R(1) : scalar_exponential(-air->shape.extinction_per_m * hit->path_m);
  if (outcome == PATH_SURFACE) put_on_surface(g, hit);
  return outcome;
}
