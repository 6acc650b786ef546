/* The only dialect switch: everything else under kernels/ is plain C that OpenCL C 1.2 and C++20 both read.

   Set by the build:  REAL_IS_DOUBLE 0|1   LANES 1|4|8   TABLE_IS_IMAGE 0|1   MEDIUM_VARIES 0|1 (along the surface)
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
DEVICE real whole_part(real x) { return floor(x); }
DEVICE real log_one_plus(real x) { return log1p(x); }
DEVICE real sine(real x) { return sin(x); }
DEVICE real cosine(real x) { return cos(x); }
#if LANES == 1
DEVICE real load_lanes(__global const scalar *p) { return *p; }
DEVICE void store_lanes(__global scalar *p, real v) { *p = v; }
DEVICE void store_bytes(__global uchar *p, mask m) { *p = (uchar)m; }
#elif LANES == 4
DEVICE real load_lanes(__global const scalar *p) { return vload4(0, p); }
DEVICE void store_lanes(__global scalar *p, real v) { vstore4(v, 0, p); }
DEVICE void store_bytes(__global uchar *p, mask m) { vstore4(convert_uchar4(m), 0, p); }
#else
DEVICE real load_lanes(__global const scalar *p) { return vload8(0, p); }
DEVICE void store_lanes(__global scalar *p, real v) { vstore8(v, 0, p); }
DEVICE void store_bytes(__global uchar *p, mask m) { vstore8(convert_uchar8(m), 0, p); }
#endif

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
DEVICE real whole_part(real x) { EACH_LANE(x, std::floor) return x; }
DEVICE real log_one_plus(real x) { EACH_LANE(x, std::log1p) return x; }
DEVICE real sine(real x) { EACH_LANE(x, std::sin) return x; }
DEVICE real cosine(real x) { EACH_LANE(x, std::cos) return x; }
#undef EACH_LANE
template <class Number> /* scalar, or a table's float in a twin of double */
DEVICE real load_lanes(const Number *p) {
  real v;
  for (int i = 0; i < LANES; ++i) reinterpret_cast<scalar *>(&v)[i] = p[i];
  return v;
}
DEVICE void store_lanes(scalar *p, real v) {
  for (int i = 0; i < LANES; ++i) p[i] = reinterpret_cast<scalar *>(&v)[i];
}
DEVICE void store_bytes(unsigned char *p, mask m) {
  for (int i = 0; i < LANES; ++i) p[i] = static_cast<unsigned char>(reinterpret_cast<lane_int *>(&m)[i]);
}
#endif

/* Asks for a place in memory that will soon be read or written: a hint, for devices where the build says so. */
#if defined(WITH_FETCH_EARLY) && WITH_FETCH_EARLY
#define FETCH_EARLY(pointer) __builtin_prefetch((const void *)(size_t)(pointer))
#else
#define FETCH_EARLY(pointer) (void)0
#endif

#define R(x) ((scalar)(x))
#define LANE(v, i) (((scalar *)&(v))[i])
#define LANE_INT(m, i) (((lane_int *)&(m))[i])

DEVICE real smaller(real a, real b) { return a < b ? a : b; }
DEVICE real larger(real a, real b) { return a > b ? a : b; }

/* OR of all lanes, by halves: the built-in any() is slow on PoCL. */
DEVICE int any_lane(mask m) {
#if LANES == 1
  return m != 0;
#elif defined(__OPENCL_C_VERSION__)
#if LANES == 8
  const int4 four = m.lo | m.hi;
  const int2 two = four.lo | four.hi;
#elif REAL_IS_DOUBLE
  const long2 two = m.lo | m.hi;
#else
  const int2 two = m.lo | m.hi;
#endif
  return (two.x | two.y) != 0;
#else
  lane_int seen = 0;
  for (int i = 0; i < LANES; ++i) seen |= LANE_INT(m, i);
  return seen != 0;
#endif
}
