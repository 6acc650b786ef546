/* Boxes within dense cells. A cell of DENSE photons or more keeps them in an order in which neighbours are near each
   other (map/order_cell.h). BLOCK of them in a row are a block; boxes around blocks, around FAN blocks, around FAN of
   those and so on make a tree that needs no pointers, so that a caustic is not one long list.
   source: Kamel & Faloutsos, "Hilbert R-tree: an improved R-tree using fractals", VLDB 1994 (packing by order)
   differs: the order is not Hilbert's

   The boxes of a cell stand in an array of one number for each photon, where the cell's photons have theirs: nodes of
   NODE_SIZE floats, those above blocks first: low x of the FAN children, high x, low y, high y, low z, high z. */

#define DENSE 1025
#define BLOCK 32
#define FAN 8
#define NODE_SIZE (6 * FAN)
#define MOST_LEVELS 9 /* 32 * 8^9 is more than 2^31 */
#define HUGE_F 3e38f

/* What a cell's tree looks like: level 0 has blocks as children, the last one is a single node. */
typedef struct Levels {
  int count;
  int nodes[MOST_LEVELS];
  int first[MOST_LEVELS]; /* node of the level */
} Levels;

DEVICE Levels levels_of(int photons) {
  Levels levels;
  int children = (photons - 1) / BLOCK + 1, first = 0;
  levels.count = 0;
  do {
    children = (children - 1) / FAN + 1;
    levels.nodes[levels.count] = children;
    levels.first[levels.count++] = first;
    first += children;
  } while (children > 1);
  return levels;
}

/* Blocks of a cell that lie within a distance of a place: as they stand, several at once where they are neighbours; or
   the nearest child of a node first, for who may learn on the way that a smaller distance will do. */
typedef struct Walk {
  GLOBAL const float *boxes;
  int begin, end; /* photons of the cell */
  int nearest_first;
  Levels levels;
  int level; /* that is being looked at; levels.count: nothing is left */
  int node[MOST_LEVELS];
  int open[MOST_LEVELS];      /* as they stand: one bit for each child that is still to be met */
  int keys[MOST_LEVELS][FAN]; /* nearest first: keys_of_children; MET once they have been met */
  int first, last;            /* photons first .. last - 1 of the block or blocks */
} Walk;

#define MET 0x7fffffff

/* Squared distances of a place from LANES boxes. Of a photon in a box the squared distance, worked out in the same way,
   is not smaller, for rounding is monotone. */
DEVICE real box_distances2(GLOBAL const float *node, float x, float y, float z) {
  const real none = SPREAD(0);
  const real dx = larger(larger(load_lanes(node) - x, x - load_lanes(node + FAN)), none),
             dy = larger(larger(load_lanes(node + 2 * FAN) - y, y - load_lanes(node + 3 * FAN)), none),
             dz = larger(larger(load_lanes(node + 4 * FAN) - z, z - load_lanes(node + 5 * FAN)), none);
  return (dx * dx + dy * dy) + dz * dz;
}

/* The bits of floats that are not negative are in the order of the floats: a squared distance, rounded down to make
   room for the child's number. */
DEVICE void keys_of_children(int *keys, GLOBAL const float *node, float x, float y, float z) {
  for (int c = 0; c < FAN; c += LANES)
    store_private_ints(keys + c, (float_bits(box_distances2(node + c, x, y, z)) & ~(FAN - 1)) | (LANE_NUMBERS + c));
}

DEVICE int least_key(const int *keys) {
  mask least = load_private_ints(keys);
  for (int c = LANES; c < FAN; c += LANES) {
    const mask other = load_private_ints(keys + c);
    least = other < least ? other : least;
  }
  return lane_least(least);
}

DEVICE void enter_node(Walk *walk, int level, int node, float x, float y, float z, float limit2) {
  GLOBAL const float *boxes = walk->boxes + (walk->levels.first[level] + node) * NODE_SIZE;
  walk->level = level;
  walk->node[level] = node;
  if (walk->nearest_first) {
    keys_of_children(walk->keys[level], boxes, x, y, z);
    return;
  }
  walk->open[level] = 0;
  for (int c = 0; c < FAN; c += LANES) walk->open[level] |= lane_bits(box_distances2(boxes + c, x, y, z) < limit2) << c;
}

DEVICE void start_walk(Walk *walk, GLOBAL const float *boxes, int begin, int end, float x, float y, float z,
                       float limit2, int nearest_first) {
  walk->boxes = boxes + begin;
  walk->begin = begin, walk->end = end;
  walk->nearest_first = nearest_first;
  walk->levels = levels_of(end - begin);
  enter_node(walk, walk->levels.count - 1, 0, x, y, z, limit2);
}

/* The next children of the node to be met, *count neighbours, the first one as the result; -1: there are none. */
DEVICE int next_children(Walk *walk, float limit2, int *count) {
  const int level = walk->level;
  *count = 1;
  if (walk->nearest_first) {
    const int key = least_key(walk->keys[level]), child = key & (FAN - 1);
    walk->keys[level][child] = MET;
    return (key & ~(FAN - 1)) < scalar_bits(limit2) ? child : -1;
  }
  const int open = walk->open[level];
  if (open == 0) return -1;
  const int child = lowest_bit(open);
  if (level == 0) *count = lowest_bit(~(open >> child));
  walk->open[level] = open & ~(((1 << *count) - 1) << child);
  return child;
}

/* The next block, or blocks, that come nearer than the root of limit2, which may be smaller than before; 0 when there
   is none. */
DEVICE int next_block(Walk *walk, float x, float y, float z, float limit2) {
  while (walk->level < walk->levels.count) {
    int count;
    const int level = walk->level, child = next_children(walk, limit2, &count);
    if (child < 0) {
      ++walk->level;
      continue;
    }
    const int number = walk->node[level] * FAN + child, last = walk->begin + (number + count) * BLOCK;
    if (level > 0) {
      enter_node(walk, level - 1, number, x, y, z, limit2);
      continue;
    }
    walk->first = walk->begin + number * BLOCK;
    walk->last = last < walk->end ? last : walk->end;
    return 1;
  }
  return 0;
}
