// Included once per namespace by surface_twin.hpp: the kernel headers of paths among surfaces, then their macros taken
// away again. No include guard.
#include "surface/surface.h"

#undef DEVICE
#undef GLOBAL
#undef CONSTANT
#undef SPREAD
#undef SPREAD_INT
#undef R
#undef LANE
#undef LANE_INT
#undef SCALAR_MATH
#undef NODE_WIDTH
#undef HUGE_BOX_M
#undef LEAF_KIND_SPHERE
#undef MOST_LEAF_BLOCKS
#undef TREE_STACK
#undef NO_PRIMITIVE
#undef MOST_PATH_ARCS
#undef GEOMETRY_BUFFERS
#undef GEOMETRY_OF_BUFFERS
#undef AIR_BUFFERS
#undef AIR_OF_BUFFERS
#undef CHAIN_ARCS
#undef HALF_METRE
