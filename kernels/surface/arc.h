/* A piece of a path, and how it meets boxes, triangles and spheres.

   place(sigma) = place + momentum sigma + bend sigma^2 z,  0 <= sigma <= end. Straight pieces have bend 0; with
   AIR_IS_CURVED 0 all pieces do, and the terms with bend are not compiled. */

typedef struct Arc {
  Vec3 place, momentum;
  scalar bend;  /* half the acceleration of z [1/m] */
  scalar lag;   /* the path's momentum less the arc's, at both ends: lag (1 - 6 t (1-t)) at sigma = t end */
  scalar start; /* sigma of its place on the whole chain */
  scalar from;  /* hits before this are not taken: 0, or a little less where a piece continues another */
  scalar end;
} Arc;

#if AIR_IS_CURVED
#define CHAIN_ARCS 8
#else
#define CHAIN_ARCS 1
#endif

/* Arcs that follow each other, searched for together: horizontally all of them are one straight line. */
typedef struct Chain {
  Arc arc[CHAIN_ARCS];
  int arcs;
  scalar from, end; /* of all, in the chain's sigma */
  scalar length;    /* sigma where a next chain begins: a hair before the end */
} Chain;

typedef struct Nearest {
  scalar sigma; /* on the chain; hits beyond this are not taken */
  scalar along; /* the same on its arc */
  int arc;
  int primitive;
  scalar u, v;
} Nearest;

DEVICE Nearest nothing_before(scalar sigma) {
  Nearest n;
  n.sigma = n.along = sigma;
  n.arc = 0;
  n.primitive = NO_PRIMITIVE;
  n.u = n.v = R(0);
  return n;
}

DEVICE Vec3 place_on(const Arc *arc, scalar sigma) {
  Vec3 p = along(arc->place, sigma, arc->momentum);
#if AIR_IS_CURVED
  p.z += arc->bend * sigma * sigma;
#endif
  return p;
}

DEVICE Vec3 momentum_on(const Arc *arc, scalar sigma) {
  Vec3 p = arc->momentum;
#if AIR_IS_CURVED
  p.z += R(2) * arc->bend * sigma;
#else
  (void)sigma;
#endif
  return p;
}

/* The chain as a box test wants it: its chord in height, and how far the path may be below and above it. */
typedef struct BoxRay {
  Vec3 place, inverse;        /* of the chord */
  int near_x, near_y, near_z; /* where the nearer of the two planes stands in a node: a multiple of NODE_WIDTH */
#if AIR_IS_CURVED
  scalar near_shift, far_shift; /* of the z planes [m] */
#endif
} BoxRay;

DEVICE scalar safe_inverse(scalar x) {
  const scalar least = R(1e-18);
  return R(1) / (scalar_magnitude(x) > least ? x : (x < R(0) ? -least : least));
}

#if AIR_IS_CURVED
/* Within an arc z - z_chord = -bend sigma (end - sigma): on one side of the arc's own chord and at most bend end^2/4
   away from it; and that chord is between its two ends.  slope: of the chain's chord */
DEVICE void bulge_of_chain(const Chain *c, scalar slope, scalar slack, scalar *lowest, scalar *highest) {
  scalar low = R(0), high = R(0);
  for (int i = 0; i < c->arcs; ++i) {
    const Arc *a = &c->arc[i];
    const scalar here = a->place.z - c->arc[0].place.z - slope * a->start;
    const scalar there = here + ((a->momentum.z - slope) + a->bend * a->end) * a->end;
    const scalar sag = R(-0.25) * a->bend * a->end * a->end;
    low = scalar_smaller(low, scalar_smaller(here, there) + scalar_smaller(sag, R(0)));
    high = scalar_larger(high, scalar_larger(here, there) + scalar_larger(sag, R(0)));
  }
  *lowest = low - slack;
  *highest = high + slack;
}
#endif

DEVICE BoxRay box_ray(const Chain *c, scalar slack) {
  BoxRay r;
  Vec3 chord = c->arc[0].momentum;
#if AIR_IS_CURVED
  scalar low, high;
  const Arc *last = &c->arc[c->arcs - 1];
  const scalar rise = last->place.z - c->arc[0].place.z + (last->momentum.z + last->bend * last->end) * last->end;
  chord.z = c->arcs == 1 ? chord.z + last->bend * last->end : rise / (last->start + last->end);
  bulge_of_chain(c, chord.z, slack, &low, &high);
  r.near_shift = chord.z < R(0) ? -low : -high;
  r.far_shift = chord.z < R(0) ? -high : -low;
#else
  (void)slack;
#endif
  r.place = c->arc[0].place;
  r.inverse = vec3(safe_inverse(chord.x), safe_inverse(chord.y), safe_inverse(chord.z));
  r.near_x = chord.x < R(0) ? 3 * NODE_WIDTH : 0;
  r.near_y = chord.y < R(0) ? 4 * NODE_WIDTH : NODE_WIDTH;
  r.near_z = chord.z < R(0) ? 5 * NODE_WIDTH : 2 * NODE_WIDTH;
  return r;
}

/* Which of LANES boxes the chain may meet between from and until: never misses one.
   box: boxes of a node, moved on by whole groups of LANES;  enter, leave: sigma before and after which it does not meet
   them */
DEVICE int meet_boxes(GLOBAL const scalar *box, const BoxRay *r, scalar from, scalar until, real *enter, real *leave) {
  const real near_x = (load_lanes(box + r->near_x) - r->place.x) * r->inverse.x;
  const real far_x = (load_lanes(box + (3 * NODE_WIDTH - r->near_x)) - r->place.x) * r->inverse.x;
  const real near_y = (load_lanes(box + r->near_y) - r->place.y) * r->inverse.y;
  const real far_y = (load_lanes(box + (5 * NODE_WIDTH - r->near_y)) - r->place.y) * r->inverse.y;
  const real near_plane = load_lanes(box + r->near_z) - r->place.z;
  const real far_plane = load_lanes(box + (7 * NODE_WIDTH - r->near_z)) - r->place.z;
#if AIR_IS_CURVED
  const real near_z = (near_plane + r->near_shift) * r->inverse.z;
  const real far_z = (far_plane + r->far_shift) * r->inverse.z;
#else
  const real near_z = near_plane * r->inverse.z, far_z = far_plane * r->inverse.z;
#endif
  const real first = larger(larger(near_x, near_y), larger(near_z, SPREAD(from)));
  /* 3 roundings of each of the two ends: Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013 */
  const real last = smaller(smaller(far_x, far_y), smaller(far_z, SPREAD(until))) * R(1.0000005);
  *enter = first;
  *leave = last;
  return lane_bits(first <= last);
}

/* Which of LANES triangles of a block the arc meets at *sigma, a solution of its meeting with their planes. */
DEVICE int inside_triangles(GLOBAL const scalar *block, const Arc *arc, scalar until, real sigma, real *u, real *v) {
  const real x = arc->place.x + arc->momentum.x * sigma, y = arc->place.y + arc->momentum.y * sigma;
#if AIR_IS_CURVED
  const real z = arc->place.z + (arc->momentum.z + arc->bend * sigma) * sigma;
#else
  const real z = arc->place.z + arc->momentum.z * sigma;
#endif
  GLOBAL const scalar *p = block + TRIANGLE_U * LANES;
  *u = load_lanes(p) * x + load_lanes(p + LANES) * y + (load_lanes(p + 2 * LANES) * z + load_lanes(p + 3 * LANES));
  p = block + TRIANGLE_V * LANES;
  *v = load_lanes(p) * x + load_lanes(p + LANES) * y + (load_lanes(p + 2 * LANES) * z + load_lanes(p + 3 * LANES));
  p = block + TRIANGLE_SLACK * LANES;
  return lane_bits((sigma >= arc->from) & (sigma <= until) & (*u >= -load_lanes(p)) & (*v >= -load_lanes(p + LANES)) &
                   (*u + *v <= R(1) + load_lanes(p + 2 * LANES)));
}

DEVICE void take_hits(int bits, GLOBAL const int *ids, real sigma, real u, real v, const Arc *arc, int number,
                      Nearest *nearest) {
  for (; bits != 0; bits &= bits - 1) {
    const int i = lowest_bit(bits), primitive = ids[i];
    const scalar s = arc->start + LANE(sigma, i);
    /* Equal places (a shared edge): the lower number, whatever the order of the tree. */
    if (s > nearest->sigma || (s == nearest->sigma && (unsigned int)primitive >= (unsigned int)nearest->primitive))
      continue;
    nearest->sigma = s;
    nearest->along = LANE(sigma, i);
    nearest->arc = number;
    nearest->primitive = primitive;
    nearest->u = LANE(u, i);
    nearest->v = LANE(v, i);
  }
}

DEVICE void meet_triangles(GLOBAL const scalar *block, GLOBAL const int *ids, const Arc *arc, int number,
                           Nearest *nearest) {
  const real nx = load_lanes(block), ny = load_lanes(block + LANES), nz = load_lanes(block + 2 * LANES);
  const real above = nx * arc->place.x + ny * arc->place.y + (nz * arc->place.z + load_lanes(block + 3 * LANES));
  const real rate = nx * arc->momentum.x + ny * arc->momentum.y + nz * arc->momentum.z;
  const scalar until = scalar_smaller(arc->end, nearest->sigma - arc->start);
  real u, v;
#if AIR_IS_CURVED
  if (arc->bend != R(0)) {
    /* bend_n sigma^2 + rate sigma + above = 0 without cancellation. A plane is met twice, once or not at all. */
    const real bend = nz * arc->bend, discriminant = rate * rate - R(4) * bend * above;
    const real width = root(larger(discriminant, SPREAD(0)));
    const real q = R(-0.5) * (rate + (rate < R(0) ? -width : width));
    const mask met = discriminant >= R(0);
    const real one = met ? above / q : SPREAD(HUGE_BOX_M), other = met ? q / bend : SPREAD(HUGE_BOX_M);
    int bits = inside_triangles(block, arc, until, one, &u, &v);
    if (bits != 0) take_hits(bits, ids, one, u, v, arc, number, nearest);
    if (lane_bits((other >= arc->from) & (other <= until)) == 0) return;
    bits = inside_triangles(block, arc, until, other, &u, &v);
    if (bits != 0) take_hits(bits, ids, other, u, v, arc, number, nearest);
    return;
  }
#endif
  const real sigma = -above / rate;
  const int bits = inside_triangles(block, arc, until, sigma, &u, &v);
  if (bits != 0) take_hits(bits, ids, sigma, u, v, arc, number, nearest);
}

/* Signed: |place - centre|^2 - radius^2 without cancellation of the two squares. */
DEVICE scalar outside_sphere(GLOBAL const SurfaceSphere *s, Vec3 place) {
  const scalar distance = length3(minus(place, load_vec3(s->centre)));
  return (distance - s->radius_m) * (distance + s->radius_m);
}

DEVICE scalar slope_from_sphere(GLOBAL const SurfaceSphere *s, const Arc *arc, scalar sigma) {
  return R(2) * dot3(minus(place_on(arc, sigma), load_vec3(s->centre)), momentum_on(arc, sigma));
}

/* Newton from outside the crossing: the squared distance is convex along any arc whose radius of curvature is larger
   than its distance from the centre, so each step stays on the same side and none can jump over the sphere.
   returns: sigma of the first crossing, or -1 */
DEVICE scalar sigma_to_sphere(GLOBAL const SurfaceSphere *s, const Arc *arc, scalar until) {
  const int starts_inside = outside_sphere(s, arc->place) < R(0);
  scalar sigma = starts_inside ? until : R(0);
  if (starts_inside && outside_sphere(s, place_on(arc, until)) < R(0)) return R(-1);
  for (int i = 0; i < 48; ++i) {
    const scalar slope = slope_from_sphere(s, arc, sigma);
    if (starts_inside ? slope <= R(0) : slope >= R(0)) return R(-1);
    const scalar step = -outside_sphere(s, place_on(arc, sigma)) / slope;
    sigma += step;
    if (!(sigma >= arc->from && sigma <= until * R(1.0001))) return R(-1);
    if (scalar_magnitude(step) <= R(3e-7) * until) break;
  }
  return sigma;
}

DEVICE void meet_sphere(GLOBAL const SurfaceSphere *s, int primitive, const Arc *arc, int number, Nearest *nearest) {
  /* From inside, a path without end is followed to the far side of the sphere at most. */
  const scalar span = R(4) * (length3(minus(arc->place, load_vec3(s->centre))) + s->radius_m);
  const scalar speed = length3(arc->momentum);
  const scalar until = scalar_smaller(arc->end, nearest->sigma - arc->start);
  const scalar along = sigma_to_sphere(s, arc, scalar_smaller(until, span / speed));
  if (!(along >= arc->from) || along > until) return;
  const scalar sigma = arc->start + along;
  if (sigma == nearest->sigma && (unsigned int)primitive >= (unsigned int)nearest->primitive) return;
  nearest->sigma = sigma;
  nearest->along = along;
  nearest->arc = number;
  nearest->primitive = primitive;
  nearest->u = nearest->v = R(0);
}
