/* The support of a density estimate: which part of the disc around a place is a surface that photons could land on.
   Over the edge of a table, behind a wall, under a block that stands on the floor there is none, and an estimate that
   divides by the whole disc is too dark: by half along every edge of a room.

   source: Hey & Purgathofer, "Advanced radiance estimation for photon map global illumination", CGF 21 (2002), who
   clip the polygons around; here the surfaces are asked by short segments, so that any tree of primitives will do. */

#define COVER_RIM 6      /* looks at the rim: if all find a surface, the disc is taken as whole */
#define COVER_SAMPLES 16 /* looks into the disc otherwise */
#define COVER_WALLS 12   /* looks at what stands in a disc that is not whole */
#define COVER_LEAST 0.0625f

typedef struct CoverDisc {
  Vec3 place, normal, first, second;
  scalar radius, height, facing;
} CoverDisc;

/* The next surface on a segment that is not glass: photons pass through that. */
DEVICE int find_past_glass(const Geometry *g, GLOBAL const Material *materials, Vec3 from, Vec3 way, SurfaceHit *hit) {
  Chain chain;
  Arc *arc = &chain.arc[0];
  arc->place = from;
  arc->momentum = way;
  arc->bend = arc->lag = arc->start = arc->from = R(0);
  arc->end = R(1);
  chain.arcs = 1;
  chain.end = R(1);
  for (int i = 0; i < 4; ++i) {
    chain.from = arc->from;
    Nearest nearest = nothing_before(arc->end);
    find_nearest(g, &chain, &nearest);
    if (nearest.primitive == NO_PRIMITIVE) return 0;
    hit->primitive = nearest.primitive;
    hit->u = nearest.u;
    hit->v = nearest.v;
    hit->place = place_on(arc, nearest.along);
    const int kind = materials[material_of(g, nearest.primitive)].kind;
    if (kind != MATERIAL_DIELECTRIC && kind != MATERIAL_ROUGH_DIELECTRIC) return 1;
    arc->from = nearest.along * R(1.000001) + R(1e-6);
  }
  return 0;
}

enum DiscLook {
  LOOK_EMPTY = 0,
  LOOK_COVERED = 1, /* a Lambert surface in sight */
  LOOK_HIDDEN = 2   /* one, but something stands before it */
};

/* What is at these coordinates of the disc's plane (in radii), seen from just above the middle. *reach: how far the
   look got [m]. */
DEVICE int look_at_disc(const Geometry *g, GLOBAL const Material *materials, const CoverDisc *d, scalar x, scalar y,
                        scalar *reach, Vec3 *place) {
  const Vec3 way = along(times(d->first, x * d->radius), y * d->radius, d->second);
  const Vec3 above = along(d->place, d->height, d->normal);
  SurfaceHit hit;
  const int blocked = find_past_glass(g, materials, above, way, &hit);
  if (blocked) *reach = length3(minus(hit.place, above));
  if (!find_past_glass(g, materials, plus(above, way), times(d->normal, R(-2) * d->height), &hit)) return LOOK_EMPTY;
  if (materials[material_of(g, hit.primitive)].kind != MATERIAL_LAMBERT) return LOOK_EMPTY;
  put_on_surface(g, &hit);
  if (scalar_magnitude(dot3(hit.normal, d->normal)) < d->facing) return LOOK_EMPTY;
  *place = hit.place;
  return blocked ? LOOK_HIDDEN : LOOK_COVERED;
}

DEVICE CoverDisc cover_disc(const Geometry *g, const GatherPoint *point, scalar radius, const CoverSettings *s) {
  CoverDisc d;
  d.place = vec3(point->place_m[0], point->place_m[1], point->place_m[2]);
  d.normal =
      unit3(vec3(unpack_normal(point->normal, 0), unpack_normal(point->normal, 1), unpack_normal(point->normal, 2)));
  frame_around(d.normal, &d.first, &d.second);
  d.radius = radius;
  /* Normals are packed to 1/511, so that the disc's rim may be off by 0.002 of its radius. */
  d.height = scalar_larger(s->height * radius, R(4) * g->bounds.clearance_m);
  d.facing = s->facing;
  return d;
}

/* What a leaf has to do with a disc. */
enum DiscMeeting {
  DISC_APART = 0,  /* nothing within its radius */
  DISC_INSIDE = 1, /* one triangle holds all of it */
  DISC_MIXED = 2   /* anything else */
};

/* A ball that the edges of a triangle, drawn through space along its normal, leave outside does not touch it; u, v and
   1 - u - v are heights over the sides, in units of TRIANGLE_SLACK / dilation_m. */
DEVICE int disc_meets_block(const Geometry *g, GLOBAL const Material *materials, int number, const CoverDisc *d) {
  GLOBAL const scalar *block = g->blocks + number * (TRIANGLE_SCALARS * LANES);
  const Vec3 p = d->place;
  const real nx = load_lanes(block), ny = load_lanes(block + LANES), nz = load_lanes(block + 2 * LANES);
  const real above = magnitude(nx * p.x + ny * p.y + (nz * p.z + load_lanes(block + 3 * LANES)));
  GLOBAL const scalar *row = block + TRIANGLE_U * LANES;
  const real u = load_lanes(row) * p.x + load_lanes(row + LANES) * p.y +
                 (load_lanes(row + 2 * LANES) * p.z + load_lanes(row + 3 * LANES));
  row = block + TRIANGLE_V * LANES;
  const real v = load_lanes(row) * p.x + load_lanes(row + LANES) * p.y +
                 (load_lanes(row + 2 * LANES) * p.z + load_lanes(row + 3 * LANES));
  row = block + TRIANGLE_SLACK * LANES;
  const real reach = SPREAD(d->radius / g->bounds.dilation_m);
  const real at_u = load_lanes(row) * reach, at_v = load_lanes(row + LANES) * reach,
             at_w = load_lanes(row + 2 * LANES) * reach, w = R(1) - u - v;
  /* Lanes that fill up a block have no slack. */
  const mask apart = (above > d->radius) | (u < -at_u) | (v < -at_v) | (w < -at_w) | (at_u <= R(0));
  const mask inside = (above <= R(4) * g->bounds.dilation_m) & (u > at_u) & (v > at_v) & (w > at_w) &
                      (magnitude(nx * d->normal.x + ny * d->normal.y + nz * d->normal.z) > R(0.999));
  const int near_by = lane_bits(apart ? SPREAD_INT(0) : SPREAD_INT(-1)), holding = lane_bits(inside) & near_by;
  if (near_by == 0) return DISC_APART;
  if (near_by != holding || (holding & (holding - 1)) != 0) return DISC_MIXED;
  const int primitive = g->block_ids[number * LANES + lowest_bit(holding)];
  return materials[material_of(g, primitive)].kind == MATERIAL_LAMBERT ? DISC_INSIDE : DISC_MIXED;
}

DEVICE int disc_meets_leaf(const Geometry *g, GLOBAL const Material *materials, int leaf, const CoverDisc *d) {
  const int code = ~leaf, first = code >> 5, count = ((code >> 1) & (MOST_LEAF_BLOCKS - 1)) + 1;
  int met = DISC_APART;
  for (int i = first; i < first + count && met != DISC_MIXED; ++i) {
    if (code & LEAF_KIND_SPHERE) {
      const scalar distance = length3(minus(d->place, load_vec3(g->spheres[i].centre)));
      if (scalar_magnitude(distance - g->spheres[i].radius_m) <= d->radius) met = DISC_MIXED;
    } else {
      met += disc_meets_block(g, materials, i, d);
    }
  }
  return met;
}

/* 1: one triangle holds the whole disc, and nothing else is as near. */
DEVICE int disc_is_plain(const Geometry *g, GLOBAL const Material *materials, const CoverDisc *d) {
  int stack[TREE_STACK], top = 1, met = DISC_APART;
  stack[0] = 0;
  const Vec3 p = d->place;
  const scalar r = d->radius;
  while (top > 0 && met < DISC_MIXED) {
    const int child = stack[--top];
    if (child < 0) {
      met += disc_meets_leaf(g, materials, child, d);
      continue;
    }
    GLOBAL const scalar *box = g->boxes + child * (6 * NODE_WIDTH);
    for (int k = 0; k < NODE_WIDTH; k += LANES) {
      GLOBAL const scalar *low = box + k, *high = box + (3 * NODE_WIDTH + k);
      const mask near_by = (load_lanes(low) <= p.x + r) & (load_lanes(high) >= p.x - r) &
                           (load_lanes(low + NODE_WIDTH) <= p.y + r) & (load_lanes(high + NODE_WIDTH) >= p.y - r) &
                           (load_lanes(low + 2 * NODE_WIDTH) <= p.z + r) &
                           (load_lanes(high + 2 * NODE_WIDTH) >= p.z - r);
      for (int bits = lane_bits(near_by); bits != 0; bits &= bits - 1)
        stack[top++] = g->children[child * NODE_WIDTH + k + lowest_bit(bits)];
    }
  }
  return met == DISC_INSIDE;
}

DEVICE void note_hidden(Cover *cover, const CoverDisc *d, scalar reach, Vec3 place) {
  if (reach >= cover->clear * d->radius) return;
  cover->clear = reach / d->radius;
  cover->hidden[0] = place.x;
  cover->hidden[1] = place.y;
  cover->hidden[2] = place.z;
}

/* turn: 0..1, of the pattern of looks, so that neighbouring places do not err alike */
DEVICE Cover find_cover(const Geometry *g, GLOBAL const Material *materials, const CoverDisc *d, scalar turn) {
  Cover cover;
  cover.whole = cover.inner = cover.clear = 1;
  cover.hidden[0] = cover.hidden[1] = cover.hidden[2] = 0;
  if (!(d->radius > R(0)) || disc_is_plain(g, materials, d)) return cover;
  int all = 1;
  scalar reach;
  Vec3 place;
  for (int i = 0; i < COVER_RIM && all; ++i) {
    const scalar angle = TWO_PI * ((scalar)i + turn) / COVER_RIM;
    all = look_at_disc(g, materials, d, R(0.9) * scalar_cosine(angle), R(0.9) * scalar_sine(angle), &reach, &place) ==
          LOOK_COVERED;
  }
  if (all) return cover;
  /* Equal shares of the kernel 1 - q, q = (d/r)^2: u = 2 q - q^2. The kernel of half the area is 1 - 2 q. */
  scalar whole = R(0), inner = R(0), inner_all = R(0);
  for (int i = 0; i < COVER_SAMPLES; ++i) {
    const scalar u = ((scalar)i + R(0.5)) / COVER_SAMPLES, q = R(1) - scalar_root(R(1) - u), distance = scalar_root(q);
    const scalar angle = TWO_PI * (R(0.618033988749895) * (scalar)i + turn);
    const scalar weight = q < R(0.5) ? (R(1) - R(2) * q) / (R(1) - q) : R(0);
    inner_all += weight;
    if (look_at_disc(g, materials, d, distance * scalar_cosine(angle), distance * scalar_sine(angle), &reach, &place) !=
        LOOK_COVERED)
      continue;
    whole += R(1);
    inner += weight;
  }
  /* The rim in all directions: the nearest point of a wall is at most 15 degrees beside one of them. */
  for (int i = 0; i < COVER_WALLS; ++i) {
    const scalar angle = TWO_PI * ((scalar)i + turn) / COVER_WALLS;
    if (look_at_disc(g, materials, d, scalar_cosine(angle), scalar_sine(angle), &reach, &place) == LOOK_HIDDEN)
      note_hidden(&cover, d, reach, place);
  }
  cover.whole = scalar_larger(whole / COVER_SAMPLES, COVER_LEAST);
  cover.inner = scalar_larger(inner / inner_all, COVER_LEAST);
  return cover;
}
