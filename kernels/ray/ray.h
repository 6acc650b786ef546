/* Everything the ray needs, in order; the one header that kernels and the host twin include. */
#include "lib/language.h"

#include "shared/index_table.h"

#include "shared/ray.h"

#if MEDIUM_VARIES
#include "shared/section_table.h"

#include "medium/section_lookup.h"
#else
#include "medium/refractivity_lookup.h"
#endif

#include "ray/equation.h"

#include "ray/dormand_prince.h"

#include "ray/richardson.h"

#include "ray/trace.h"
