/* Photons filed by cell: a stable counting sort in two digits, without atomics, that moves each photon once.

   The records are cut into chunks that fit a second-level cache. Each chunk deals its photons out by the high digit of
   their keys, the bucket, into a region of its own: nothing has to be known of other chunks. A bucket is then the sum
   of one piece of each chunk; one work-item sorts it by the low digit, which leaves the starts of its cells behind, and
   writes the arrays of the map. The order is that of the photons before, whatever the number of chunks: equal keys
   never pass each other.
   source: Zagha & Blelloch, "Radix sort for vector multiprocessors", Supercomputing '91 (counting by chunk)
   differs: the first digit is dealt within the chunk, so no count of all of them comes before it */

typedef struct SortPlan {
  int photons;
  int chunk; /* photons of one work-item */
  int chunks;
  int buckets;
  int row;   /* counters of a chunk: more than buckets, whole groups of lanes */
  int shift; /* bucket = cell >> shift */
  int cells;
} SortPlan;

/* What the sort has to know of a photon, in half a cache line. */
typedef struct MovedPhoton {
  float place_m[3];
  unsigned int index; /* of its record */
  unsigned int normal;
  int cell;
  float power_W[2]; /* WAVES <= 2; of more wavelengths it stays with the record */
} MovedPhoton;

/* In one store: stores that wait for their cache lines are what dealing costs. */
DEVICE void move_photon(GLOBAL MovedPhoton *to, GLOBAL const Photon *from, int index, int cell, const float *power) {
#ifdef __OPENCL_C_VERSION__
  const uint8 words = (uint8)(as_uint(from->place_m[0]), as_uint(from->place_m[1]), as_uint(from->place_m[2]),
                              (uint)index, from->normal, (uint)cell, as_uint(power[0]), as_uint(power[1]));
  vstore8(words, 0, (GLOBAL uint *)to);
#else
  *to = MovedPhoton{{from->place_m[0], from->place_m[1], from->place_m[2]},
                    (unsigned)index,
                    from->normal,
                    cell,
                    {power[0], power[1]}};
#endif
}

/* Whether the photons of a chunk stand in the order of (id, bounce), empty slots apart. */
typedef struct ChunkOrder {
  unsigned int first_id, first_bounce, last_id, last_bounce;
  int photons;
  int unsorted;
} ChunkOrder;

/* What came out. */
typedef struct Filing {
  int filed;    /* photons in the map */
  int unsorted; /* records did not stand in the order of (id, bounce) */
} Filing;

DEVICE int comes_before(unsigned int id, unsigned int bounce, unsigned int other_id, unsigned int other_bounce) {
  return id < other_id || (id == other_id && bounce < other_bounce);
}

DEVICE void note_order(ChunkOrder *order, unsigned int id, unsigned int bounce) {
  if (order->photons == 0) order->first_id = id, order->first_bounce = bounce;
  else order->unsorted |= comes_before(id, bounce, order->last_id, order->last_bounce);
  order->last_id = id, order->last_bounce = bounce;
  ++order->photons;
}

/* LANES photons. */
typedef struct PhotonLanes {
  real x, y, z;
  mask id, tags;
} PhotonLanes;

/* Of `left` that there are; beyond them the first again. */
DEVICE PhotonLanes read_photons(GLOBAL const Photon *photons, int left) {
  PhotonLanes lanes;
#if LANES == 8 && defined(__OPENCL_C_VERSION__)
#define RECORD(l) vload8(0, (GLOBAL const uint *)(photons + (l < left ? l : 0)))
  Words8 words = {RECORD(0), RECORD(1), RECORD(2), RECORD(3), RECORD(4), RECORD(5), RECORD(6), RECORD(7)};
#undef RECORD
  transpose(&words);
  lanes.x = as_float8(words.a), lanes.y = as_float8(words.b), lanes.z = as_float8(words.c);
  lanes.id = as_int8(words.g), lanes.tags = as_int8(words.h);
#else
  for (int l = 0; l < LANES; ++l) {
    GLOBAL const Photon *photon = photons + (l < left ? l : 0);
    LANE(lanes.x, l) = photon->place_m[0];
    LANE(lanes.y, l) = photon->place_m[1];
    LANE(lanes.z, l) = photon->place_m[2];
    LANE_INT(lanes.id, l) = (int)photon->id;
    LANE_INT(lanes.tags, l) = (int)photon->tags;
  }
#endif
  return lanes;
}

/* Empty slots and photons that are nowhere: plan->cells. */
DEVICE mask cells_of_photons(const SortPlan *plan, const PhotonGrid *grid, const PhotonLanes *lanes) {
  const real sum = lanes->x + lanes->y + lanes->z;
  const mask is_somewhere = ((lanes->tags >> 16) != PHOTON_NONE) & (sum - sum == 0);
  return is_somewhere ? cells_of(grid, lanes->x, lanes->y, lanes->z) : SPREAD_INT(plan->cells);
}

/* The first `here` of the lanes, those without a cell apart. */
DEVICE void note_order_of(ChunkOrder *order, const SortPlan *plan, const PhotonLanes *lanes, mask cells, int here) {
#if LANES == 8 && defined(__OPENCL_C_VERSION__)
  if (here == 8 && !any_lane(cells == plan->cells)) {
    const uint8 id = as_uint8(lanes->id), bounce = PHOTON_BOUNCE(as_uint8(lanes->tags));
    const uint8 id_before =
                    (uint8)(order->photons ? order->last_id : 0, id.s0, id.s1, id.s2, id.s3, id.s4, id.s5, id.s6),
                bounce_before = (uint8)(order->photons ? order->last_bounce : 0, bounce.s0, bounce.s1, bounce.s2,
                                        bounce.s3, bounce.s4, bounce.s5, bounce.s6);
    order->unsorted |= any_lane((id < id_before) | ((id == id_before) & (bounce < bounce_before)));
    if (order->photons == 0) order->first_id = id.s0, order->first_bounce = bounce.s0;
    order->last_id = id.s7, order->last_bounce = bounce.s7;
    order->photons += 8;
    return;
  }
#endif
  for (int l = 0; l < here; ++l)
    if (LANE_INT(cells, l) != plan->cells)
      note_order(order, (unsigned int)LANE_INT(lanes->id, l), PHOTON_BOUNCE((unsigned int)LANE_INT(lanes->tags, l)));
}

/* One chunk by bucket. start[row]: where the pieces of the buckets begin in `moved`, and behind the last one its end.
   While it counts and deals, start[b + 1] is what bucket b has, then where its next photon goes.
   cells[photons]: room for the cells of the photons. */
DEVICE ChunkOrder deal_chunk(const SortPlan *plan, const PhotonGrid *grid, GLOBAL const Photon *photons,
                             GLOBAL const float *power_W, GLOBAL int *cells, GLOBAL MovedPhoton *moved,
                             GLOBAL int *start, int chunk) {
  const int first = chunk * plan->chunk;
  const int last = first + plan->chunk < plan->photons ? first + plan->chunk : plan->photons;
  ChunkOrder order = {0, 0, 0, 0, 0, 0};
  for (int b = 0; b < plan->row; ++b) start[b] = 0;
  for (int i = first; i < last; i += LANES) {
    const int here = last - i < LANES ? last - i : LANES;
    const PhotonLanes lanes = read_photons(photons + i, here);
    mask group = cells_of_photons(plan, grid, &lanes);
    note_order_of(&order, plan, &lanes, group, here);
    for (int l = 0; l < here; ++l) {
      const int cell = LANE_INT(group, l);
      cells[i + l] = cell;
      if (cell != plan->cells) ++start[(cell >> plan->shift) + 1];
    }
  }
  int sum = first;
  start[0] = first;
  for (int b = 1; b < plan->row; ++b) {
    const int count = start[b];
    start[b] = sum;
    sum += count;
  }
  for (int i = first; i < last; ++i) {
    FETCH_EARLY(photons + i + 16); /* a second time: a chunk is larger than the second-level cache */
    const int cell = cells[i];
    if (cell == plan->cells) continue;
    const int to = start[(cell >> plan->shift) + 1]++;
    float power[2] = {0, 0};
#if WAVES <= 2
    for (int w = 0; w < WAVES; ++w) power[w] = power_W[i * WAVES + w];
#endif
    FETCH_EARLY(moved + to + 2); /* the bucket's next cache line */
    move_photon(moved + to, photons + i, i, cell, power);
  }
  return order;
}

/* Photons of LANES buckets in all chunks. */
DEVICE mask bucket_totals(const SortPlan *plan, GLOBAL const int *starts, int bucket) {
  mask sum = SPREAD_INT(0);
  for (int c = 0; c < plan->chunks; ++c)
    sum += load_ints(starts + c * plan->row + bucket + 1) - load_ints(starts + c * plan->row + bucket);
  return sum;
}

/* Totals of the buckets -> where each begins in the map, and the total behind them. */
DEVICE Filing scan_totals(const SortPlan *plan, GLOBAL const ChunkOrder *orders, GLOBAL int *bucket_start) {
  Filing filing = {0, 0};
  for (int b = 0; b < plan->buckets; ++b) {
    const int count = bucket_start[b];
    bucket_start[b] = filing.filed;
    filing.filed += count;
  }
  bucket_start[plan->buckets] = filing.filed;
  int before = -1;
  for (int c = 0; c < plan->chunks; ++c) {
    if (orders[c].photons == 0) continue;
    filing.unsorted |= orders[c].unsorted;
    if (before >= 0)
      filing.unsorted |=
          comes_before(orders[c].first_id, orders[c].first_bounce, orders[before].last_id, orders[before].last_bounce);
    before = c;
  }
  return filing;
}
