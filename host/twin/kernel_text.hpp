// Included once per namespace by twin.hpp: the kernel headers, then their macros taken away again. No include guard.
#include "ray/ray.h"

#include "lib/random.h"
#include "medium/height.h"
#include "shared/layers.h"
#include "shared/probe.h"
#include "shared/sky.h"
#include "sky/sky.h"

#include "ray/closed_form.h"

#include "ray/closed_form_path.h"

#include "ray/closed_form_place.h"

#undef DEVICE
#undef GLOBAL
#undef CONSTANT
#undef SPREAD
#undef SPREAD_INT
#undef R
#undef LANE
#undef LANE_INT
#undef INDEX_CELL_TEXELS
#undef INDEX_CELL_SCALARS
#undef INDEX_TABLE
#undef PROBE_VALUES
#undef LAYER_QUANTITIES_SUMMED
#undef LIMB_TERMS
#undef ROUNDING
#undef LANDING
#undef SMALLEST
#undef INTEGRATOR_STEP
