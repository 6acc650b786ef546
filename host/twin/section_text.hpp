// Included once per namespace by section_twin.hpp: the kernel headers, then their macros taken away again. No include
// guard.
#include "ray/ray.h"
#include "twin/undo_macros.hpp"
