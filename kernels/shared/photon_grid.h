/* The grid that files photons by place, and what a gather is asked to do. Plain types, as in shared/photon.h. */

/* Cells of edge 1/per_m, x fastest: the cells of one row that a gather visits lie side by side in memory. Along x, and
   along y and z while wrap is 0, places outside are filed in the outermost cell. With wrap the rows are taken modulo
   cells[1] and cells[2], both powers of two: a spatial hash that keeps rows whole. */
typedef struct PhotonGrid {
  float origin_m[3];
  float per_m;
  int cells[3];
  int wrap;
} PhotonGrid;

enum GatherKernel {
  GATHER_FLAT = 0,        /* every photon counts alike */
  GATHER_CONE = 1,        /* 1 - d/(k r), k = 1.1 */
  GATHER_EPANECHNIKOV = 2 /* 1 - d^2/r^2 */
};

typedef struct GatherSettings {
  float radius_m; /* of the gather, 0: each point has its own; for the nearest k: the largest to look through */
  float guess_m;  /* nearest k: where the search begins; any value gives the same photons */
  /* A photon at height h over the surface counts as if it were at d^2 + squash h^2: the support is an ellipsoid of
     flatness 1/sqrt(1 + squash); 0: a sphere. */
  float squash;
  float facing; /* photons whose surface normal has a smaller cosine with the asking one are left out; -2: none is */
  int nearest;  /* k */
} GatherSettings;

/* Where a gather came from. */
typedef struct Gathered {
  float radius_m; /* of the estimate */
  int count;      /* photons inside */
} Gathered;

/* What else a gather can tell of the irradiance summed over the wavelengths. */
typedef struct GatherSpread {
  float inner_W_m2;     /* from the disc of half the area: the difference tells the bias */
  float variance_W2_m4; /* of a Poisson process with these photons: the sum of the squares of what each adds */
} GatherSpread;
