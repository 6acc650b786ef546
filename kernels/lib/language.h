/* The only dialect switch: everything else under kernels/ is plain C that OpenCL C 1.2 and C++20 both read.

   Set by the build:  REAL_IS_DOUBLE 0|1   LANES 1|4|8   TABLE_IS_IMAGE 0|1
   scalar   float or double.
   real     what a work-item computes with: LANES scalars side by side (PoCL: 8 floats), or one (GPUs).
   mask     one truth value per lane, also used for whole numbers per lane. `m ? a : b` selects lane by lane in both
   languages. LANE(v, i), LANE_INT(m, i)   one lane of a real or of a mask. */

#ifdef __OPENCL_C_VERSION__ /* ------------------------------------------------------------------ device */
#define DEVICE static inline
#define GLOBAL __global
#define CONSTANT __constant const
#if REAL_IS_DOUBLE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
typedef double scalar;
#else
typedef float scalar;
#endif
#if LANES == 1
typedef scalar real;
typedef int mask;
typedef int lane_int;
#elif REAL_IS_DOUBLE
typedef double4 real;
typedef long4 mask;
typedef long lane_int;
#elif LANES == 4
typedef float4 real;
typedef int4 mask;
typedef int lane_int;
#else
typedef float8 real;
typedef int8 mask;
typedef int lane_int;
#endif
#define SPREAD(x) ((real)(x))
#define SPREAD_INT(x) ((mask)(x))
DEVICE real root(real x) { return sqrt(x); }
DEVICE real magnitude(real x) { return fabs(x); }
DEVICE real exponential(real x) { return exp(x); }

#else /* ------------------------------------------------------------------ host twin; <cmath> is included before */
#define DEVICE inline
#define GLOBAL
#define CONSTANT static const
#if REAL_IS_DOUBLE
typedef double scalar;
#else
typedef float scalar;
#endif
#if LANES == 1
typedef scalar real;
typedef int mask;
typedef int lane_int;
#define SPREAD(x) ((scalar)(x))
#define SPREAD_INT(x) ((int)(x))
#else
#if REAL_IS_DOUBLE
typedef long lane_int;
#else
typedef int lane_int;
#endif
typedef scalar real __attribute__((vector_size(LANES * sizeof(scalar))));
typedef lane_int mask __attribute__((vector_size(LANES * sizeof(lane_int))));
#define SPREAD(x) (real{} + (scalar)(x))
#define SPREAD_INT(x) (mask{} + (lane_int)(x))
#endif
#define EACH_LANE(v, f)                       \
  for (int lane_ = 0; lane_ < LANES; ++lane_) \
    reinterpret_cast<scalar *>(&(v))[lane_] = f(reinterpret_cast<scalar *>(&(v))[lane_]);
DEVICE real root(real x) { EACH_LANE(x, std::sqrt) return x; }
DEVICE real magnitude(real x) { EACH_LANE(x, std::fabs) return x; }
DEVICE real exponential(real x) { EACH_LANE(x, std::exp) return x; }
#undef EACH_LANE
#endif

#define R(x) ((scalar)(x))
#define LANE(v, i) (((scalar *)&(v))[i])
#define LANE_INT(m, i) (((lane_int *)&(m))[i])

DEVICE real smaller(real a, real b) { return a < b ? a : b; }
DEVICE real larger(real a, real b) { return a > b ? a : b; }

/* Branch-free OR of all lanes: the built-in any() is slow on PoCL. */
DEVICE int any_lane(mask m) {
#if LANES == 1
  return m != 0;
#else
  lane_int seen = 0;
  for (int i = 0; i < LANES; ++i) seen |= LANE_INT(m, i);
  return seen != 0;
#endif
}
