// Included once per namespace by surface_twin.hpp: the kernel headers of paths among surfaces, then their macros taken
// away again. No include guard.
#include "surface/surface.h"

#include "twin/undo_macros.hpp"
