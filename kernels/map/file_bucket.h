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

/* places[photon of the map] = its number among the moved ones; starts of the bucket's cells.
   While it counts and sorts, cell_start[k + 1] is what cell k has, then where its next photon goes; at the end that is
   the start of k + 1. */
DEVICE void sort_bucket(const SortPlan *plan, GLOBAL const MovedPhoton *moved, GLOBAL const int *starts, int filed,
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
  int sum = filed;
  for (int k = low; k < high; ++k) {
    const int count = next[k];
    next[k] = sum;
    sum += count;
  }
  for (int c = 0; c < plan->chunks; ++c) {
    const int last = starts[c * plan->row + bucket + 1];
    for (int i = starts[c * plan->row + bucket]; i < last; ++i) places[next[moved[i].cell]++] = (unsigned int)i;
  }
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

/* Photons first .. last - 1 of the map. order[]: places among the moved ones before, numbers of records afterwards. */
DEVICE void write_photons(const FiledArrays *map, GLOBAL const MovedPhoton *moved, GLOBAL const float *power_W,
                          int first, int last) {
  for (int i = first; i < last; ++i) {
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
}

DEVICE void write_zeros(const FiledArrays *map, int first) {
  for (int i = first; i < first + LANES; ++i) {
    map->x_m[i] = map->y_m[i] = map->z_m[i] = 0;
    map->normal[i] = 0;
    for (int w = 0; w < WAVES; ++w) map->power_W[w * map->stride + i] = 0;
  }
}
