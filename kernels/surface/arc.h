/* A piece of a path inside one cell of the medium, and how it meets boxes, triangles and spheres.

   place(sigma) = place + momentum sigma + bend sigma^2 z,  0 <= sigma <= end. Straight pieces have bend 0; with
   AIR_IS_CURVED 0 all pieces do, and the terms with bend are not compiled. */

typedef struct Arc {
  Vec3 place, momentum;
  scalar bend; /* [1/m], see AirCell */
  scalar from; /* hits before this are not taken: 0, or a little less where a piece continues another */
  scalar end;
} Arc;

typedef struct Nearest {
  scalar sigma; /* hits beyond this are not taken */
  int primitive;
  scalar u, v;
} Nearest;

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

/* The arc as a box test wants it: its chord, and how far it bulges from it. */
typedef struct BoxRay {
  Vec3 place, inverse;        /* of the chord */
  int near_x, near_y, near_z; /* where the nearer of the two planes stands in a node: a multiple of NODE_WIDTH */
#if AIR_IS_CURVED
  scalar near_shift, far_shift; /* of the z planes [m] */
  scalar rise, bend, turn;      /* p_z, bend, and the sigma at which p_z is 0 */
#endif
} BoxRay;

DEVICE scalar safe_inverse(scalar x) {
  const scalar least = R(1e-18);
  return R(1) / (scalar_magnitude(x) > least ? x : (x < R(0) ? -least : least));
}

DEVICE BoxRay box_ray(const Arc *arc) {
  BoxRay r;
  Vec3 chord = arc->momentum;
#if AIR_IS_CURVED
  /* z - z_chord = -bend sigma (end - sigma): on one side of the chord and at most bend end^2/4 away from it. */
  const scalar sag = R(0.25) * arc->bend * arc->end * arc->end;
  chord.z += arc->bend * arc->end;
  const scalar low_shift = scalar_smaller(sag, R(0)), high_shift = scalar_larger(sag, R(0));
  r.near_shift = chord.z < R(0) ? high_shift : low_shift;
  r.far_shift = chord.z < R(0) ? low_shift : high_shift;
  r.rise = arc->momentum.z;
  r.bend = arc->bend;
  r.turn = arc->bend != R(0) ? R(-0.5) * arc->momentum.z / arc->bend : R(0);
#endif
  r.place = arc->place;
  r.inverse = vec3(safe_inverse(chord.x), safe_inverse(chord.y), safe_inverse(chord.z));
  r.near_x = chord.x < R(0) ? 3 * NODE_WIDTH : 0;
  r.near_y = chord.y < R(0) ? 4 * NODE_WIDTH : NODE_WIDTH;
  r.near_z = chord.z < R(0) ? 5 * NODE_WIDTH : 2 * NODE_WIDTH;
  return r;
}

/* Which of LANES boxes the arc may meet between from and until: never misses one.
   box: boxes of a node, moved on by whole groups of LANES;  enter: sigma before which it does not meet them */
DEVICE int meet_boxes(GLOBAL const scalar *box, const BoxRay *r, scalar from, scalar until, real *enter) {
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
#if AIR_IS_CURVED
  /* Between first and last the height is between those at both ends and at the turning point. */
  const real turn = smaller(larger(SPREAD(r->turn), first), last);
  const real a = (first * r->bend + r->rise) * first, b = (last * r->bend + r->rise) * last;
  const real c = (turn * r->bend + r->rise) * turn;
  const real highest = larger(larger(a, b), c), lowest = smaller(smaller(a, b), c);
  const mask in_height = r->inverse.z < R(0) ? (highest >= far_plane) & (lowest <= near_plane)
                                             : (highest >= near_plane) & (lowest <= far_plane);
  return lane_bits((first <= last) & in_height);
#else
  return lane_bits(first <= last);
#endif
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

DEVICE void take_hits(int bits, GLOBAL const int *ids, real sigma, real u, real v, Nearest *nearest) {
  for (; bits != 0; bits &= bits - 1) {
    const int i = lowest_bit(bits), primitive = ids[i];
    const scalar s = LANE(sigma, i);
    /* Equal places (a shared edge): the lower number, whatever the order of the tree. */
    if (s > nearest->sigma || (s == nearest->sigma && (unsigned int)primitive >= (unsigned int)nearest->primitive))
      continue;
    nearest->sigma = s;
    nearest->primitive = primitive;
    nearest->u = LANE(u, i);
    nearest->v = LANE(v, i);
  }
}

DEVICE void meet_triangles(GLOBAL const scalar *block, GLOBAL const int *ids, const Arc *arc, Nearest *nearest) {
  const real nx = load_lanes(block), ny = load_lanes(block + LANES), nz = load_lanes(block + 2 * LANES);
  const real above = nx * arc->place.x + ny * arc->place.y + (nz * arc->place.z + load_lanes(block + 3 * LANES));
  const real rate = nx * arc->momentum.x + ny * arc->momentum.y + nz * arc->momentum.z;
  real u, v;
#if AIR_IS_CURVED
  /* bend_n sigma^2 + rate sigma + above = 0 without cancellation. A plane is met twice, once or not at all. */
  const real bend = nz * arc->bend, discriminant = rate * rate - R(4) * bend * above;
  const real width = root(larger(discriminant, SPREAD(0)));
  const real q = R(-0.5) * (rate + (rate < R(0) ? -width : width));
  const mask met = discriminant >= R(0);
  const real one = met ? above / q : SPREAD(-1), other = met ? q / bend : SPREAD(-1);
  int bits = inside_triangles(block, arc, nearest->sigma, one, &u, &v);
  if (bits != 0) take_hits(bits, ids, one, u, v, nearest);
  if (arc->bend == R(0) || lane_bits((other >= arc->from) & (other <= nearest->sigma)) == 0) return;
  bits = inside_triangles(block, arc, nearest->sigma, other, &u, &v);
  if (bits != 0) take_hits(bits, ids, other, u, v, nearest);
#else
  const real sigma = -above / rate;
  const int bits = inside_triangles(block, arc, nearest->sigma, sigma, &u, &v);
  if (bits != 0) take_hits(bits, ids, sigma, u, v, nearest);
#endif
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

DEVICE void meet_sphere(GLOBAL const SurfaceSphere *s, int primitive, const Arc *arc, Nearest *nearest) {
  /* From inside, a path without end is followed to the far side of the sphere at most. */
  const scalar span = R(4) * (length3(minus(arc->place, load_vec3(s->centre))) + s->radius_m);
  const scalar speed = length3(arc->momentum);
  const scalar sigma = sigma_to_sphere(s, arc, scalar_smaller(nearest->sigma, span / speed));
  if (!(sigma >= arc->from) || sigma > nearest->sigma) return;
  if (sigma == nearest->sigma && (unsigned int)primitive >= (unsigned int)nearest->primitive) return;
  nearest->sigma = sigma;
  nearest->primitive = primitive;
  nearest->u = nearest->v = R(0);
}
