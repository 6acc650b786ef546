// Included once per namespace by twin.hpp: the kernel headers, then their macros taken away again. No include guard.
#include "ray/ray.h"

#include "lib/random.h"
#include "medium/height.h"
#include "shared/layers.h"
#include "shared/probe.h"
#include "shared/sky.h"
#include "sky/sky.h"

#include "shared/target.h"
#include "sky/target.h"

#include "ray/closed_form.h"

#include "ray/closed_form_path.h"

#include "ray/closed_form_place.h"

#include "twin/undo_macros.hpp"
