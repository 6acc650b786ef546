/* Photons of a dense cell in an order in which neighbours are near each other, and the boxes around them.

   The photons are sorted by the eighth (or quarter) of their common bounding box that they lie in, along each axis, in
   Morton order; every part that is left with many of them has the same done to it. Boxes fit what they hold, so a few
   steps reach from a metre down to a micrometre, wherever the light has gathered. Sorting is stable: of photons at the
   same place the one emitted first comes first. */

#define SPLIT 128       /* parts with more photons than that are divided further */
#define WIDE_SPLIT 4096 /* by eighths from here on, by quarters below */

typedef struct Box {
  float low[3], high[3];
} Box;

DEVICE Box empty_box(void) {
  const Box box = {{HUGE_F, HUGE_F, HUGE_F}, {-HUGE_F, -HUGE_F, -HUGE_F}};
  return box;
}

DEVICE void grow_box(Box *box, GLOBAL const MovedPhoton *photon) {
  for (int axis = 0; axis < 3; ++axis) {
    const float place = photon->place_m[axis];
    box->low[axis] = scalar_smaller(box->low[axis], place);
    box->high[axis] = scalar_larger(box->high[axis], place);
  }
}

/* Parts of a box: cubes with 1 << bits of them along its longest side. */
typedef struct Parts {
  float low[3];
  float per_m;
  int bits;
} Parts;

/* 0 where the box is a point, or too small or too large to be divided in floats. */
DEVICE int divide_box(Parts *parts, const Box *box, int bits) {
  float longest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    parts->low[axis] = box->low[axis];
    longest = scalar_larger(longest, box->high[axis] - box->low[axis]);
  }
  parts->bits = bits;
  parts->per_m = (float)(1 << bits) / longest;
  return parts->per_m > 1e-30f && parts->per_m < 1e30f;
}

/* Two or three bits, with two places left free behind each. */
DEVICE int spread_bits(int part) { return (part & 1) | (part & 2) << 2 | (part & 4) << 4; }

DEVICE int part_of(const Parts *parts, GLOBAL const MovedPhoton *photon) {
  int code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int part = (int)((photon->place_m[axis] - parts->low[axis]) * parts->per_m), most = (1 << parts->bits) - 1;
    code |= spread_bits(part < most ? part : most) << axis;
  }
  return code;
}

/* Photons begin .. end - 1 by part, stably. next[parts + 1]: afterwards where each part begins, and the end. */
DEVICE void sort_by_part(const Parts *parts, GLOBAL const MovedPhoton *moved, GLOBAL unsigned int *places,
                         GLOBAL unsigned int *spare, int begin, int end, int *next) {
  const int count = 1 << 3 * parts->bits;
  for (int k = 0; k <= count; ++k) next[k] = 0;
  for (int i = begin; i < end; ++i) {
    spare[i] = places[i];
    ++next[part_of(parts, moved + places[i])];
  }
  int sum = begin;
  for (int k = 0; k <= count; ++k) {
    const int here = next[k];
    next[k] = sum;
    sum += here;
  }
  for (int i = begin; i < end; ++i) places[next[part_of(parts, moved + spare[i])]++] = spare[i];
  for (int k = count; k > 0; --k) next[k] = next[k - 1];
  next[0] = begin;
}

/* Photons begin .. end - 1 of the map, a dense cell. todo: room for as many numbers as the cell has photons: the parts
   that are still to be divided. */
DEVICE void order_cell(GLOBAL const MovedPhoton *moved, GLOBAL unsigned int *places, GLOBAL unsigned int *spare,
                       GLOBAL int *todo, int begin, int end) {
  int next[513];
  int waiting = 1;
  todo[0] = begin, todo[1] = end;
  while (waiting > 0) {
    --waiting;
    const int first = todo[2 * waiting], last = todo[2 * waiting + 1];
    Box box = empty_box();
    for (int i = first; i < last; ++i) grow_box(&box, moved + places[i]);
    Parts parts;
    if (!divide_box(&parts, &box, last - first > WIDE_SPLIT ? 3 : 2)) continue;
    sort_by_part(&parts, moved, places, spare, first, last, next);
    for (int k = 0; k < 1 << 3 * parts.bits; ++k)
      if (next[k + 1] - next[k] > SPLIT && next[k + 1] - next[k] < last - first) {
        todo[2 * waiting] = next[k], todo[2 * waiting + 1] = next[k + 1];
        ++waiting;
      }
  }
}

DEVICE void write_child(GLOBAL float *node, int child, const Box *box) {
  for (int axis = 0; axis < 3; ++axis) {
    node[2 * axis * FAN + child] = box->low[axis];
    node[(2 * axis + 1) * FAN + child] = box->high[axis];
  }
}

DEVICE Box box_of_node(GLOBAL const float *node) {
  Box box = empty_box();
  for (int child = 0; child < FAN; ++child)
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = scalar_smaller(box.low[axis], node[2 * axis * FAN + child]);
      box.high[axis] = scalar_larger(box.high[axis], node[(2 * axis + 1) * FAN + child]);
    }
  return box;
}

/* boxes: of the cell begin .. end - 1. Children that do not exist have boxes that nothing is near to. */
DEVICE void write_boxes(GLOBAL float *boxes, GLOBAL const MovedPhoton *moved, GLOBAL const unsigned int *places,
                        int begin, int end) {
  const Levels levels = levels_of(end - begin);
  for (int block = 0; block < levels.nodes[0] * FAN; ++block) {
    Box box = empty_box();
    const int first = begin + block * BLOCK, last = first + BLOCK < end ? first + BLOCK : end;
    for (int i = first; i < last; ++i) grow_box(&box, moved + places[i]);
    write_child(boxes + block / FAN * NODE_SIZE, block % FAN, &box);
  }
  for (int level = 1; level < levels.count; ++level)
    for (int child = 0; child < levels.nodes[level] * FAN; ++child) {
      Box box = empty_box();
      if (child < levels.nodes[level - 1]) box = box_of_node(boxes + (levels.first[level - 1] + child) * NODE_SIZE);
      write_child(boxes + (levels.first[level] + child / FAN) * NODE_SIZE, child % FAN, &box);
    }
}
