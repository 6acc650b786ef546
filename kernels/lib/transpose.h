/* Eight records of eight words <-> eight words of eight records, in registers. Only for kernels of eight lanes.
   WITHOUT_SHUFFLES: for oclgrind 21.10, whose check of uninitialised values fails at swizzles of another width. */

#define PAIRS_LOW(a, b) (uint8)(a.s0, b.s0, a.s1, b.s1, a.s4, b.s4, a.s5, b.s5)
#define PAIRS_HIGH(a, b) (uint8)(a.s2, b.s2, a.s3, b.s3, a.s6, b.s6, a.s7, b.s7)
#ifdef WITHOUT_SHUFFLES
#define FOURS_LOW(a, b) (uint8)(a.s0, a.s1, b.s0, b.s1, a.s4, a.s5, b.s4, b.s5)
#define FOURS_HIGH(a, b) (uint8)(a.s2, a.s3, b.s2, b.s3, a.s6, a.s7, b.s6, b.s7)
#define HALVES_LOW(a, b) (uint8)(a.s0, a.s1, a.s2, a.s3, b.s0, b.s1, b.s2, b.s3)
#define HALVES_HIGH(a, b) (uint8)(a.s4, a.s5, a.s6, a.s7, b.s4, b.s5, b.s6, b.s7)
#else
#define FOURS_LOW(a, b) (uint8)(a.s01, b.s01, a.s45, b.s45)
#define FOURS_HIGH(a, b) (uint8)(a.s23, b.s23, a.s67, b.s67)
#define HALVES_LOW(a, b) (uint8)(a.lo, b.lo)
#define HALVES_HIGH(a, b) (uint8)(a.hi, b.hi)
#endif

/* Fields of their own, not an array: only those stay in registers. */
typedef struct Words8 {
  uint8 a, b, c, d, e, f, g, h;
} Words8;

/* Eight records -> a: their first words; b: their second; and so on. */
DEVICE void transpose(Words8 *r) {
  const uint8 ab0 = PAIRS_LOW(r->a, r->b), ab1 = PAIRS_HIGH(r->a, r->b), cd0 = PAIRS_LOW(r->c, r->d),
              cd1 = PAIRS_HIGH(r->c, r->d), ef0 = PAIRS_LOW(r->e, r->f), ef1 = PAIRS_HIGH(r->e, r->f),
              gh0 = PAIRS_LOW(r->g, r->h), gh1 = PAIRS_HIGH(r->g, r->h);
  const uint8 low0 = FOURS_LOW(ab0, cd0), low1 = FOURS_HIGH(ab0, cd0), low2 = FOURS_LOW(ab1, cd1),
              low3 = FOURS_HIGH(ab1, cd1), high0 = FOURS_LOW(ef0, gh0), high1 = FOURS_HIGH(ef0, gh0),
              high2 = FOURS_LOW(ef1, gh1), high3 = FOURS_HIGH(ef1, gh1);
  r->a = HALVES_LOW(low0, high0), r->b = HALVES_LOW(low1, high1);
  r->c = HALVES_LOW(low2, high2), r->d = HALVES_LOW(low3, high3);
  r->e = HALVES_HIGH(low0, high0), r->f = HALVES_HIGH(low1, high1);
  r->g = HALVES_HIGH(low2, high2), r->h = HALVES_HIGH(low3, high3);
}

#undef PAIRS_LOW
#undef PAIRS_HIGH
#undef FOURS_LOW
#undef FOURS_HIGH
#undef HALVES_LOW
#undef HALVES_HIGH
