// Included once per namespace by section_twin.hpp: the kernel headers, then their macros taken away again. No include
// guard.
#include "ray/ray.h"

#undef DEVICE
#undef GLOBAL
#undef CONSTANT
#undef SPREAD
#undef SPREAD_INT
#undef R
#undef LANE
#undef LANE_INT
#undef SECTION_CELL_SCALARS
#undef INDEX_CELL_TEXELS
#undef INDEX_CELL_SCALARS
#undef INDEX_TABLE
#undef ROUNDING
#undef LANDING
#undef SMALLEST
#undef INTEGRATOR_STEP
