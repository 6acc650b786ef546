/* Photons filed by cell: a stable counting sort in two digits, without atomics.

   The photons are cut into chunks. Each chunk counts its keys by their high digit (the bucket) in a row of its own; the
   counts are summed over buckets, then chunks; each chunk then deals its keys out in order. Within a bucket one
   work-item sorts by the low digit, which leaves the starts of the cells behind. The order is that of the photons
   before, whatever the number of chunks: equal keys never pass each other.
   source: Zagha & Blelloch, "Radix sort for vector multiprocessors", Supercomputing '91 (counting by chunk) */

enum SortKey { KEY_CELL = 0, KEY_ID = 1, KEY_BOUNCE = 2 };

typedef struct KeyedPhoton {
  unsigned int key;
  unsigned int index; /* of the photon in the record array */
} KeyedPhoton;

typedef struct SortPlan {
  int photons;
  int chunk;   /* photons of one work-item */
  int buckets; /* values of the digit */
  int shift;   /* bucket = (key >> shift) & digit_mask */
  unsigned int digit_mask;
  int key;        /* SortKey */
  int from_order; /* 1: photons are taken in the order that the pairs stand in; 0: in their own */
} SortPlan;

DEVICE int bucket_of(const SortPlan *plan, unsigned int key) { return (int)((key >> plan->shift) & plan->digit_mask); }

/* Key of one photon. Empty slots, and photons that are nowhere, sort behind the last cell and are left out. */
DEVICE unsigned int sort_key(const SortPlan *plan, const PhotonGrid *grid, const Photon *photon) {
  if (plan->key == KEY_ID) return photon->id;
  if (plan->key == KEY_BOUNCE) return PHOTON_BOUNCE(photon->tags);
  const float sum = photon->place_m[0] + photon->place_m[1] + photon->place_m[2];
  if (PHOTON_KIND(photon->tags) == PHOTON_NONE || !(sum - sum == 0)) return (unsigned int)grid_cells(grid);
  return (unsigned int)cell_of(grid, &photon->place_m[0], &photon->place_m[1], &photon->place_m[2]);
}

DEVICE int last_of_chunk(const SortPlan *plan, int first) {
  return first + plan->chunk < plan->photons ? first + plan->chunk : plan->photons;
}

/* Whether photons stand in the order of (id, bounce), empty slots apart. */
typedef struct ChunkOrder {
  unsigned int first_id, first_bounce, last_id, last_bounce;
  int photons;
  int unsorted;
} ChunkOrder;

DEVICE void note_order(ChunkOrder *order, const Photon *photon) {
  if (PHOTON_KIND(photon->tags) == PHOTON_NONE) return;
  const unsigned int id = photon->id, bounce = PHOTON_BOUNCE(photon->tags);
  if (order->photons == 0) order->first_id = id, order->first_bounce = bounce;
  else order->unsorted |= id < order->last_id || (id == order->last_id && bounce < order->last_bounce);
  order->last_id = id, order->last_bounce = bounce;
  ++order->photons;
}

/* Keys and counts of one chunk. */
DEVICE ChunkOrder key_chunk(const SortPlan *plan, const PhotonGrid *grid, GLOBAL const Photon *photons,
                            GLOBAL KeyedPhoton *pairs, GLOBAL int *counts, int chunk) {
  const int first = chunk * plan->chunk, last = last_of_chunk(plan, first);
  ChunkOrder order = {0, 0, 0, 0, 0, 0};
  for (int b = 0; b < plan->buckets; ++b) counts[b] = 0;
  for (int i = first; i < last; ++i) {
    const unsigned int index = plan->from_order ? pairs[i].index : (unsigned int)i;
    const Photon photon = photons[index];
    const unsigned int key = sort_key(plan, grid, &photon);
    note_order(&order, &photon);
    pairs[i].key = key;
    pairs[i].index = index;
    ++counts[bucket_of(plan, key)];
  }
  return order;
}

/* Counts of one bucket over the chunks -> where each chunk's share starts within it. Returns the bucket's total. */
DEVICE int scan_chunks(GLOBAL int *counts, int buckets, int chunks, int bucket) {
  int sum = 0;
  for (int c = 0; c < chunks; ++c) {
    const int count = counts[c * buckets + bucket];
    counts[c * buckets + bucket] = sum;
    sum += count;
  }
  return sum;
}

/* starts: totals of the buckets -> their starts, and the total behind them. */
DEVICE void scan_buckets(GLOBAL int *starts, int buckets) {
  int sum = 0;
  for (int b = 0; b < buckets; ++b) {
    const int count = starts[b];
    starts[b] = sum;
    sum += count;
  }
  starts[buckets] = sum;
}

DEVICE void deal_chunk(const SortPlan *plan, GLOBAL const KeyedPhoton *pairs, GLOBAL KeyedPhoton *dealt,
                       GLOBAL const int *bucket_start, GLOBAL int *counts, int chunk) {
  const int first = chunk * plan->chunk, last = last_of_chunk(plan, first);
  for (int b = 0; b < plan->buckets; ++b) counts[b] += bucket_start[b];
  for (int i = first; i < last; ++i) {
    const KeyedPhoton pair = pairs[i];
    dealt[counts[bucket_of(plan, pair.key)]++] = pair;
  }
}

/* One bucket by the low digit: order[place in the map] = index of the photon; cell_start of its cells.
   While it sorts, cell_start[k + 1] is where the next photon of cell k goes; at the end that is the start of k + 1. */
DEVICE void sort_bucket(const SortPlan *plan, int cells, GLOBAL const KeyedPhoton *dealt,
                        GLOBAL const int *bucket_start, GLOBAL int *cell_start, GLOBAL unsigned int *order,
                        int bucket) {
  const int first = bucket_start[bucket], last = bucket_start[bucket + 1];
  const int low = bucket << plan->shift, above = (bucket + 1) << plan->shift, high = above < cells ? above : cells;
  GLOBAL int *next = cell_start + 1;
  if (bucket == 0) cell_start[0] = 0;
  for (int k = low; k < high; ++k) next[k] = 0;
  for (int i = first; i < last; ++i)
    if ((int)dealt[i].key < cells) ++next[dealt[i].key];
  int sum = first;
  for (int k = low; k < high; ++k) {
    const int count = next[k];
    next[k] = sum;
    sum += count;
  }
  for (int i = first; i < last; ++i) {
    const KeyedPhoton pair = dealt[i];
    if ((int)pair.key < cells) order[next[pair.key]++] = pair.index;
  }
}
