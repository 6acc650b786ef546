/* What crosses the bus for one ray: where it starts, and all that is known at its end. */

/* Start, prepared by the host in double (host/render/launch.cpp).
   run and rise are the two components of N (cos e, sin e), N the flattened index at the start and e the elevation:
   the horizontal and the vertical optical momentum. run is Bouguer's invariant and never changes. */
typedef struct RayStart {
  scalar above_m;     /* flattened height above the bottom of its cell */
  scalar run;         /* N cos e */
  scalar rise;        /* N sin e */
  scalar sigma_end_m; /* stop here: surface distance / run; ENDLESS_M or more: until it leaves */
  int row;            /* wavelength: row of the index table */
  int cell;
#if MEDIUM_VARIES
  int column;          /* cell counts from the bottom of the column */
  scalar along_m;      /* x from the left edge of the column */
  scalar course, beam; /* cosine and sine of the angle from the direction of x to that of the ray */
#endif
} RayStart;

enum RayOutcome {
  RAY_RUNNING = 0,
  RAY_SPACE = 1,     /* left the air through its top */
  RAY_GROUND = 2,    /* hit the surface */
  RAY_TRAPPED = 3,   /* an upper and a lower turning point: it never leaves */
  RAY_LIMIT = 4,     /* step limit */
  RAY_IN_FLIGHT = 5, /* reached sigma_end_m */
  RAY_NOT_FINITE = 6,
  RAY_OUTCOMES = 7
};

#define ENDLESS_M 1e20 /* of sigma: no end */

typedef struct RayEnd {
  scalar above_m, run, rise;
  scalar sigma_m;        /* d(sigma) = ds/n in flattened space; surface distance = run * sigma. Where the medium varies
                            along the surface run does, too: then sigma_m is the surface distance over the last run */
  scalar bending_rad;    /* total turning of the tangent, positive toward the surface */
  scalar optical_path_m; /* integral of n ds */
  scalar column[3];      /* air [kg/m^2], ozone and aerosol [m of sea-level density: shape 1 at its peak] */
  scalar min_z_m, max_z_m;
  scalar solver_error_rad; /* sum of the local error estimates of direction and bending */
  scalar bouguer_drift;    /* |ln| change of n r cos e that should be 0: the run-time alarm */
  int cell;
  int outcome;
  int turning_points;
  int steps; /* accepted */
  int rejected;
#if MEDIUM_VARIES
  int column_number;
  scalar along_m;
  scalar sideways_rad; /* turned out of the vertical plane in which it was seen, to the side of `beam` */
#endif
} RayEnd;

/* The vertical shapes of ozone and aerosol, 1 at the peak. */
typedef struct Absorbers {
  scalar earth_curvature_per_m; /* 1/R, 0 for a flat surface */
  scalar ozone_peak_m, ozone_width_m;
  scalar aerosol_scale_m;
} Absorbers;
