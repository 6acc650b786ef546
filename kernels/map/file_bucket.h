/* A bucket of the counting sort -> its cells and its part of the map's arrays (map/photon_arrays.h), to be written. */

typedef struct FiledArrays {
  GLOBAL int *cell_start;
  GLOBAL float *boxes;
  GLOBAL float *x_m, *y_m, *z_m;
  GLOBAL unsigned int *normal;
  GLOBAL float *power_W;
  GLOBAL unsigned int *order; /* number of the record */
  int stride;
} FiledArrays;

DEVICE int emitted_before(GLOBAL const Photon *photons, GLOBAL const MovedPhoton *moved, unsigned int a,
                          unsigned int b) {
  GLOBAL const Photon *pa = photons + moved[a].index, *pb = photons + moved[b].index;
  return comes_before(pa->id, PHOTON_BOUNCE(pa->tags), pb->id, PHOTON_BOUNCE(pb->tags));
}

/* Moves the photon at the root of heap[count] down to where it belongs. */
DEVICE void sift_down(GLOBAL const Photon *photons, GLOBAL const MovedPhoton *moved, GLOBAL unsigned int *heap,
                      int root, int count) {
  const unsigned int sinking = heap[root];
  for (int child = 2 * root + 1; child < count; child = 2 * root + 1) {
    if (child + 1 < count && emitted_before(photons, moved, heap[child], heap[child + 1])) ++child;
    if (!emitted_before(photons, moved, sinking, heap[child])) break;
    heap[root] = heap[child];
    root = child;
  }
  heap[root] = sinking;
}

/* Photons of one cell by (id, bounce): heap sort. */
DEVICE void sort_by_emission(GLOBAL const Photon *photons, GLOBAL const MovedPhoton *moved, GLOBAL unsigned int *places,
                             int count) {
  for (int root = count / 2 - 1; root >= 0; --root) sift_down(photons, moved, places, root, count);
  for (int left = count - 1; left > 0; --left) {
    const unsigned int last = places[0];
    places[0] = places[left];
    places[left] = last;
    sift_down(photons, moved, places, 0, left);
  }
}

/* next[count] photons of each cell -> where each begins, the first at `sum`. Returns the photons of the fullest.
   Most cells of a room are empty: they are passed LANES at a time. */
DEVICE int scan_cells(GLOBAL int *next, int count, int sum) {
  int fullest = 0;
  for (int k = 0; k < count;) {
    if (k + LANES <= count && !any_lane(load_ints(next + k) != 0)) {
      store_ints(next + k, SPREAD_INT(sum));
      k += LANES;
      continue;
    }
    const int end = k + LANES < count ? k + LANES : count;
    for (; k < end; ++k) {
      const int here = next[k];
      fullest = here > fullest ? here : fullest;
      next[k] = sum;
      sum += here;
    }
  }
  return fullest;
}

/* places[photon of the map] = its number among the moved ones; starts of the bucket's cells. Returns the photons of its
   fullest cell.
   While it counts and sorts, cell_start[k + 1] is what cell k has, then where its next photon goes; at the end that is
   the start of k + 1. */
DEVICE int sort_bucket(const SortPlan *plan, GLOBAL const MovedPhoton *moved, GLOBAL const int *starts, int filed,
                       GLOBAL int *cell_start, GLOBAL unsigned int *places, int bucket) {
  const int low = bucket << plan->shift, above = (bucket + 1) << plan->shift;
  const int high = above < plan->cells ? above : plan->cells;
  GLOBAL int *next = cell_start + 1;
  if (bucket == 0) cell_start[0] = 0;
  for (int k = low; k < high; ++k) next[k] = 0;
  for (int c = 0; c < plan->chunks; ++c) {
    const int begin = starts[c * plan->row + bucket], last = starts[c * plan->row + bucket + 1];
    const int ahead = (c + 1 < plan->chunks ? starts[(c + 1) * plan->row + bucket] : begin) - begin;
    for (int i = begin; i < last; ++i) {
      FETCH_EARLY(moved + i + ahead); /* the next piece */
      ++next[moved[i].cell];
    }
  }
  const int fullest = scan_cells(next + low, high - low, filed);
  for (int c = 0; c < plan->chunks; ++c) {
    const int last = starts[c * plan->row + bucket + 1];
    for (int i = starts[c * plan->row + bucket]; i < last; ++i) places[next[moved[i].cell]++] = (unsigned int)i;
  }
  return fullest;
}

DEVICE void sort_cells_by_emission(const SortPlan *plan, GLOBAL const Photon *photons, GLOBAL const MovedPhoton *moved,
                                   GLOBAL const int *cell_start, GLOBAL unsigned int *places, int first, int bucket) {
  const int low = bucket << plan->shift, above = (bucket + 1) << plan->shift;
  const int high = above < plan->cells ? above : plan->cells;
  for (int k = low; k < high; ++k) { /* cell_start[low] is the neighbour's to write */
    const int begin = k == low ? first : cell_start[k];
    sort_by_emission(photons, moved, places + begin, cell_start[k + 1] - begin);
  }
}

/* first: of the bucket's photons in the map. */
DEVICE void order_dense_cells(const SortPlan *plan, const FiledArrays *map, GLOBAL const MovedPhoton *moved, int first,
                              int bucket) {
  const int low = bucket << plan->shift, above = (bucket + 1) << plan->shift;
  const int high = above < plan->cells ? above : plan->cells;
  int begin = first;
  for (int k = low; k < high; ++k) {
    const int end = map->cell_start[k + 1];
    if (end - begin >= DENSE) {
      order_cell(moved, map->order, map->normal, (GLOBAL int *)(map->boxes + begin), begin, end);
      write_boxes(map->boxes + begin, moved, map->order, begin, end);
    }
    begin = end;
  }
}

DEVICE void write_photon(const FiledArrays *map, GLOBAL const MovedPhoton *moved, GLOBAL const float *power_W, int i) {
  GLOBAL const MovedPhoton *photon = moved + map->order[i];
  map->x_m[i] = photon->place_m[0];
  map->y_m[i] = photon->place_m[1];
  map->z_m[i] = photon->place_m[2];
  map->normal[i] = photon->normal;
  map->order[i] = photon->index;
#if WAVES <= 2
  for (int w = 0; w < WAVES; ++w) map->power_W[w * map->stride + i] = photon->power_W[w];
#else
  for (int w = 0; w < WAVES; ++w) map->power_W[w * map->stride + i] = power_W[photon->index * WAVES + w];
#endif
}

#if LANES == 8 && defined(__OPENCL_C_VERSION__)
#define RECORD(l) vload8(0, (GLOBAL const uint *)(moved + map->order[i + l]))
#define WORD_TO(array, words) vstore8(words, 0, (GLOBAL uint *)(array) + i)
DEVICE void write_eight_photons(const FiledArrays *map, GLOBAL const MovedPhoton *moved, GLOBAL const float *power_W,
                                int i) {
  Words8 words = {RECORD(0), RECORD(1), RECORD(2), RECORD(3), RECORD(4), RECORD(5), RECORD(6), RECORD(7)};
  transpose(&words);
  WORD_TO(map->x_m, words.a);
  WORD_TO(map->y_m, words.b);
  WORD_TO(map->z_m, words.c);
  WORD_TO(map->order, words.d);
  WORD_TO(map->normal, words.e);
#if WAVES <= 2
  WORD_TO(map->power_W, words.g);
  if (WAVES == 2) WORD_TO(map->power_W + map->stride, words.h);
#else
  for (int l = 0; l < 8; ++l)
    for (int w = 0; w < WAVES; ++w) map->power_W[w * map->stride + i + l] = power_W[map->order[i + l] * WAVES + w];
#endif
}
#undef RECORD
#undef WORD_TO
#endif

/* Photons first .. last - 1 of the map. order[]: places among the moved ones before, numbers of records afterwards. */
DEVICE void write_photons(const FiledArrays *map, GLOBAL const MovedPhoton *moved, GLOBAL const float *power_W,
                          int first, int last) {
  int i = first;
#if LANES == 8 && defined(__OPENCL_C_VERSION__)
  for (; i < last && i % 8 != 0; ++i) write_photon(map, moved, power_W, i); /* whole cache lines from here on */
  for (; i + 8 <= last; i += 8) write_eight_photons(map, moved, power_W, i);
#endif
  for (; i < last; ++i) write_photon(map, moved, power_W, i);
}

DEVICE void write_zeros(const FiledArrays *map, int first) {
  for (int i = first; i < first + LANES; ++i) {
    map->x_m[i] = map->y_m[i] = map->z_m[i] = 0;
    map->normal[i] = 0;
    for (int w = 0; w < WAVES; ++w) map->power_W[w * map->stride + i] = 0;
  }
}
