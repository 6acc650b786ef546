/* The nearest surface on an arc, found through the tree of kernels/shared/geometry.h. */

DEVICE void meet_leaf(const Geometry *g, int leaf, const Arc *arc, Nearest *nearest) {
  const int code = ~leaf, first = code >> 5, count = ((code >> 1) & (MOST_LEAF_BLOCKS - 1)) + 1;
  for (int i = first; i < first + count; ++i) {
    if (code & LEAF_KIND_SPHERE) meet_sphere(g->spheres + i, g->bounds.triangles + i, arc, nearest);
    else meet_triangles(g->blocks + i * (TRIANGLE_SCALARS * LANES), g->block_ids + i * LANES, arc, nearest);
  }
}

typedef struct TreeStack {
  int child[TREE_STACK];
  scalar enter[TREE_STACK]; /* sigma */
  int top;
} TreeStack;

/* Puts the children of a node that the arc may meet on the stack, the nearest last. */
DEVICE void open_node(const Geometry *g, int node, const BoxRay *ray, const Arc *arc, scalar until, TreeStack *stack) {
  GLOBAL const scalar *box = g->boxes + node * (6 * NODE_WIDTH);
  GLOBAL const int *children = g->children + node * NODE_WIDTH;
  const int bottom = stack->top;
  for (int k = 0; k < NODE_WIDTH; k += LANES) {
    real enter;
    int bits = meet_boxes(box + k, ray, arc->from, until, &enter);
    for (; bits != 0; bits &= bits - 1) {
      const int i = lowest_bit(bits);
      const scalar at = LANE(enter, i);
      const int child = children[k + i];
      const int swap = stack->top > bottom && stack->enter[stack->top - 1] < at;
      const int place = stack->top - swap;
      if (swap) {
        stack->child[stack->top] = stack->child[place];
        stack->enter[stack->top] = stack->enter[place];
      }
      stack->child[place] = child;
      stack->enter[place] = at;
      ++stack->top;
    }
  }
}

/* nearest: sigma is set to where the search ends, primitive to NO_PRIMITIVE, before the call */
DEVICE void find_nearest(const Geometry *g, const Arc *arc, Nearest *nearest) {
  const BoxRay ray = box_ray(arc);
  TreeStack stack;
  stack.top = 1;
  stack.child[0] = 0;
  stack.enter[0] = arc->from;
  while (stack.top > 0) {
    --stack.top;
    if (stack.enter[stack.top] > nearest->sigma) continue;
    const int child = stack.child[stack.top];
    if (child >= 0) open_node(g, child, &ray, arc, nearest->sigma, &stack);
    else meet_leaf(g, child, arc, nearest);
  }
}
