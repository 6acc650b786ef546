/* Everything that paths among surfaces need, in order. */
#include "lib/language.h"

#include "lib/lane_bits.h"
#include "lib/vec3.h"
#include "shared/air_cell.h"
#include "shared/geometry.h"
#include "shared/path.h"

#include "surface/path.h"

#include "surface/air.h"

#include "surface/climb.h"

#include "surface/arc.h"

#include "surface/tree.h"

#include "surface/trace_to_surface.h"

#include "surface/probe_path.h"
