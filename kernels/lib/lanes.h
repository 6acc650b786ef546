/* Whole numbers per lane, and sums over the lanes. Float only. */

#ifdef __OPENCL_C_VERSION__
#if LANES == 8
DEVICE mask load_ints(__global const int *p) { return vload8(0, p); }
DEVICE void store_ints(__global int *p, mask m) { vstore8(m, 0, p); }
DEVICE mask load_private_ints(const int *p) { return vload8(0, p); }
DEVICE void store_private_ints(int *p, mask m) { vstore8(m, 0, p); }
DEVICE mask float_bits(real v) { return as_int8(v); }
DEVICE real as_reals(mask m) { return convert_float8(m); }
DEVICE mask truncated(real v) { return convert_int8(v); }
#define LANE_NUMBERS ((int8)(0, 1, 2, 3, 4, 5, 6, 7))
#elif LANES == 4
DEVICE mask load_ints(__global const int *p) { return vload4(0, p); }
DEVICE void store_ints(__global int *p, mask m) { vstore4(m, 0, p); }
DEVICE mask load_private_ints(const int *p) { return vload4(0, p); }
DEVICE void store_private_ints(int *p, mask m) { vstore4(m, 0, p); }
DEVICE mask float_bits(real v) { return as_int4(v); }
DEVICE real as_reals(mask m) { return convert_float4(m); }
DEVICE mask truncated(real v) { return convert_int4(v); }
#define LANE_NUMBERS ((int4)(0, 1, 2, 3))
#else
DEVICE mask load_ints(__global const int *p) { return *p; }
DEVICE void store_ints(__global int *p, mask m) { *p = m; }
DEVICE mask load_private_ints(const int *p) { return *p; }
DEVICE void store_private_ints(int *p, mask m) { *p = m; }
DEVICE mask float_bits(real v) { return as_int(v); }
DEVICE real as_reals(mask m) { return (float)m; }
DEVICE mask truncated(real v) { return (int)v; }
#define LANE_NUMBERS 0
#endif
DEVICE int scalar_bits(float x) { return as_int(x); }
#else
DEVICE mask load_ints(const int *p) {
  mask v = SPREAD_INT(0);
  for (int i = 0; i < LANES; ++i) LANE_INT(v, i) = p[i];
  return v;
}
DEVICE void store_ints(int *p, mask m) {
  for (int i = 0; i < LANES; ++i) p[i] = LANE_INT(m, i);
}
DEVICE mask truncated(real v) {
  mask m = SPREAD_INT(0);
  for (int i = 0; i < LANES; ++i) LANE_INT(m, i) = (int)LANE(v, i);
  return m;
}
DEVICE real as_reals(mask m) {
  real v = SPREAD(0);
  for (int i = 0; i < LANES; ++i) LANE(v, i) = (float)LANE_INT(m, i);
  return v;
}
#if LANES == 1
#define LANE_NUMBERS 0
#else
#define LANE_NUMBERS load_ints(lane_numbers)
static const int lane_numbers[8] = {0, 1, 2, 3, 4, 5, 6, 7};
#endif
#endif

/* Halves onto each other until one number is left: always in the same order. `together` takes values of any width. */
#if LANES == 1
#define FOLD_LANES(number, v, together) return v
#elif defined(__OPENCL_C_VERSION__)
#if LANES == 8
#define FOLD_LANES(number, v, together)             \
  const number##4 four = together((v).lo, (v).hi);  \
  const number##2 two = together(four.lo, four.hi); \
  return together(two.x, two.y)
#else
#define FOLD_LANES(number, v, together)           \
  const number##2 two = together((v).lo, (v).hi); \
  return together(two.x, two.y)
#endif
#else
#define FOLD_LANES(number, v, together)                                           \
  number part[LANES];                                                             \
  for (int i = 0; i < LANES; ++i) part[i] = ((number *)&(v))[i];                  \
  for (int width = LANES / 2; width > 0; width /= 2)                              \
    for (int i = 0; i < width; ++i) part[i] = together(part[i], part[i + width]); \
  return part[0]
#endif
#define SUM_OF(a, b) ((a) + (b))
#define LARGER_OF(a, b) ((a) > (b) ? (a) : (b))
#define SMALLER_OF(a, b) ((a) < (b) ? (a) : (b))

DEVICE float lane_sum(real v) { FOLD_LANES(float, v, SUM_OF); }
DEVICE int lane_count(mask counts) { FOLD_LANES(int, counts, SUM_OF); }
DEVICE float lane_largest(real v) { FOLD_LANES(float, v, LARGER_OF); }
DEVICE int lane_least(mask m) { FOLD_LANES(int, m, SMALLER_OF); }
DEVICE float lane_smallest(real v) { FOLD_LANES(float, v, SMALLER_OF); }
#undef FOLD_LANES
#undef SUM_OF
#undef LARGER_OF
#undef SMALLER_OF
