/* The nearest surface on a chain of arcs, found through the tree of kernels/shared/geometry.h. */

DEVICE void meet_leaf(const Geometry *g, int leaf, const Arc *arc, int number, Nearest *nearest) {
  const int code = ~leaf, first = code >> 5, count = ((code >> 1) & (MOST_LEAF_BLOCKS - 1)) + 1;
  for (int i = first; i < first + count; ++i) {
    if (code & LEAF_KIND_SPHERE) meet_sphere(g->spheres + i, g->bounds.triangles + i, arc, number, nearest);
    else meet_triangles(g->blocks + i * (TRIANGLE_SCALARS * LANES), g->block_ids + i * LANES, arc, number, nearest);
  }
}

#if AIR_IS_CURVED
/* Only arcs that are not over before the chain enters the leaf's box, and begin before it leaves it and before what was
   met so far. */
DEVICE void meet_leaf_by_chain(const Geometry *g, int leaf, const Chain *chain, scalar enter, scalar leave,
                               Nearest *nearest) {
  for (int i = 0; i < chain->arcs; ++i) {
    const Arc *arc = &chain->arc[i];
    if (i > 0 && arc->start + arc->from > scalar_smaller(leave, nearest->sigma)) return;
    if (i + 1 < chain->arcs && arc->start + arc->end < enter) continue;
    meet_leaf(g, leaf, arc, i, nearest);
  }
}
#endif

typedef struct TreeStack {
  int child[TREE_STACK];
  scalar enter[TREE_STACK]; /* sigma */
#if AIR_IS_CURVED
  scalar leave[TREE_STACK];
#endif
  int top;
} TreeStack;

/* Puts the children of a node that the chain may meet on the stack, the nearest last. */
DEVICE void open_node(const Geometry *g, int node, const BoxRay *ray, scalar from, scalar until, TreeStack *stack) {
  GLOBAL const scalar *box = g->boxes + node * (6 * NODE_WIDTH);
  GLOBAL const int *children = g->children + node * NODE_WIDTH;
  const int bottom = stack->top;
  for (int k = 0; k < NODE_WIDTH; k += LANES) {
    real enter, leave;
    int bits = meet_boxes(box + k, ray, from, until, &enter, &leave);
    for (; bits != 0; bits &= bits - 1) {
      const int i = lowest_bit(bits);
      const scalar at = LANE(enter, i);
      const int child = children[k + i];
      const int swap = stack->top > bottom && stack->enter[stack->top - 1] < at;
      const int place = stack->top - swap;
      if (swap) {
        stack->child[stack->top] = stack->child[place];
        stack->enter[stack->top] = stack->enter[place];
#if AIR_IS_CURVED
        stack->leave[stack->top] = stack->leave[place];
#endif
      }
      stack->child[place] = child;
      stack->enter[place] = at;
#if AIR_IS_CURVED
      stack->leave[place] = LANE(leave, i);
#endif
      ++stack->top;
    }
  }
}

/* nearest: nothing_before(where the search ends) before the call */
DEVICE void find_nearest(const Geometry *g, const Chain *chain, Nearest *nearest) {
  const BoxRay ray = box_ray(chain, g->bounds.dilation_m);
  TreeStack stack;
  stack.top = 1;
  stack.child[0] = 0;
  stack.enter[0] = chain->from;
  while (stack.top > 0) {
    --stack.top;
    const scalar enter = stack.enter[stack.top];
    if (enter > nearest->sigma) continue;
    const int child = stack.child[stack.top];
    if (child >= 0) open_node(g, child, &ray, chain->from, nearest->sigma, &stack);
#if AIR_IS_CURVED
    else meet_leaf_by_chain(g, child, chain, enter, stack.leave[stack.top], nearest);
#else
    else meet_leaf(g, child, &chain->arc[0], 0, nearest);
#endif
  }
}
