/* Paths and segments that cross the bus, for tests and benchmarks. */

typedef struct PathStart {
  scalar place[3];
  scalar momentum[3]; /* n times the unit direction */
  int row;
  int glass; /* as in Path */
} PathStart;

typedef struct PathEnd {
  scalar place[3], normal[3], momentum[3];
  scalar u, v;
  scalar path_m, transmission;
  int outcome, primitive;
  int pad_;
} PathEnd;

/* From `place` along `direction` up to sigma = 1. */
typedef struct Segment {
  scalar place[3];
  scalar direction[3]; /* not unit: its length is the segment's [m] */
} Segment;

typedef struct SegmentHit {
  scalar sigma, u, v;
  int primitive;
} SegmentHit;
