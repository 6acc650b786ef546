/* Where light has to go to meet something that is not Lambert: the emission domain of each light, its random numbers,
   cut into cells by their leading bits. */

enum ProjectionSize {
  PROJECTION_BITS = 12,
  PROJECTION_CELLS = 4096,
  PROJECTION_WORDS = 5 /* two of the direction, three of the place: see kernels/surface/emit.h */
};

typedef struct LightProjection {
  int bits[PROJECTION_WORDS]; /* of a cell's number that each word begins with, the first one lowest; in all
                                 PROJECTION_BITS */
  int first, marked;          /* cells in the list */
  scalar explored;            /* share of photons that go anywhere, so that no cell is left out; 1: all */
} LightProjection;
