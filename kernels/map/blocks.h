/* Boxes within dense cells. A cell of DENSE photons or more keeps them in an order in which neighbours are near each
   other (map/order_cell.h). BLOCK of them in a row are a block; boxes around blocks, around FAN blocks, around FAN of
   those and so on make a tree that needs no pointers, so that a caustic is not one long list.
   source: Kamel & Faloutsos, "Hilbert R-tree: an improved R-tree using fractals", VLDB 1994 (packing by order)
   differs: the order is not Hilbert's

   The boxes of a cell stand in an array of one number for each photon, where the cell's photons have theirs: nodes of
   NODE_SIZE floats, those above blocks first: low x of the FAN children, high x, low y, high y, low z, high z. */

#define DENSE 513
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

/* Blocks of a cell that lie within a distance of a place, one after the other. */
typedef struct Walk {
  GLOBAL const float *boxes;
  int begin, end; /* photons of the cell */
  Levels levels;
  int level; /* that is being looked at; levels.count: nothing is left */
  int node[MOST_LEVELS];
  int open[MOST_LEVELS]; /* one bit for each child that is still to be met */
  int first, last;       /* photons first .. last - 1 of the block */
} Walk;

/* Bits of the children of a node that come nearer to a place than the root of limit2. Of a photon in a box the squared
   distance, worked out in the same way, is not smaller, for rounding is monotone. */
DEVICE int children_within(GLOBAL const float *node, float x, float y, float z, float limit2) {
  int bits = 0;
  for (int c = 0; c < FAN; c += LANES) {
    const real none = SPREAD(0);
    const real dx = larger(larger(load_lanes(node + c) - x, x - load_lanes(node + FAN + c)), none),
               dy = larger(larger(load_lanes(node + 2 * FAN + c) - y, y - load_lanes(node + 3 * FAN + c)), none),
               dz = larger(larger(load_lanes(node + 4 * FAN + c) - z, z - load_lanes(node + 5 * FAN + c)), none);
    bits |= lane_bits((dx * dx + dy * dy) + dz * dz < limit2) << c;
  }
  return bits;
}

DEVICE void start_walk(Walk *walk, GLOBAL const float *boxes, int begin, int end, float x, float y, float z,
                       float limit2) {
  walk->boxes = boxes + begin;
  walk->begin = begin, walk->end = end;
  walk->levels = levels_of(end - begin);
  walk->level = walk->levels.count - 1;
  walk->node[walk->level] = 0;
  walk->open[walk->level] = children_within(walk->boxes + walk->levels.first[walk->level] * NODE_SIZE, x, y, z, limit2);
}

/* The next block; 0 when there is none. limit2 may be smaller than before. */
DEVICE int next_block(Walk *walk, float x, float y, float z, float limit2) {
  while (walk->level < walk->levels.count) {
    const int level = walk->level, open = walk->open[level];
    if (open == 0) {
      ++walk->level;
      continue;
    }
    walk->open[level] = open & (open - 1);
    const int child = walk->node[level] * FAN + lowest_bit(open);
    if (level == 0) {
      walk->first = walk->begin + child * BLOCK;
      walk->last = walk->first + BLOCK < walk->end ? walk->first + BLOCK : walk->end;
      return 1;
    }
    walk->level = level - 1;
    walk->node[level - 1] = child;
    walk->open[level - 1] =
        children_within(walk->boxes + (walk->levels.first[level - 1] + child) * NODE_SIZE, x, y, z, limit2);
  }
  return 0;
}
