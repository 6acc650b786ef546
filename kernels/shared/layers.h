/* A medium in layers as one eye sees it, for the closed form (kernels/ray/closed_form.h). Weighed in double by the host
   (host/atmosphere/layer_table.cpp), for the layers above the eye and for those below, each list starting at the eye.
 */

enum LayerQuantity {
  LAYER_BENDING = 0,  /* [rad], over cos(e) */
  LAYER_DISTANCE = 1, /* [m], over cos(e) */
  LAYER_PATH = 2,     /* optical path [m] */
  LAYER_AIR = 3,      /* [kg/m^2] */
  LAYER_OZONE = 4,    /* [m] */
  LAYER_AEROSOL = 5,  /* [m] */
  LAYER_QUANTITIES = 6
};

/* One layer from its near edge (towards the eye, t = 0) to its far edge (t = 1), in Legendre's polynomials of t:
     weight of a quantity = mean + tilt (t - 1/2) + bow (6 t^2 - 6 t + 1)
     lift = straight line between the edges - bulge t (1-t) + skew t (1-t) (t - 1/2)                */
typedef struct Layer {
  scalar lift; /* 1 - (N_eye/N)^2 at the far edge: sin^2 there is sin^2(e0) + cos^2(e0) lift */
  scalar bulge, skew;
  scalar far_m; /* flattened height of the far edge */
  scalar mean[LAYER_QUANTITIES];
  scalar tilt[LAYER_QUANTITIES];
  scalar bow[LAYER_QUANTITIES];
} Layer;

/* All that lies far above the eye, merged (host/atmosphere/far_nodes.cpp): there the medium acts on a ray through its
   lift alone, and a few lifts with weights stand for the whole of it:  integral of w dz / sin e = sum of weight / sin
   e(lift). Their number is a multiple of 4. */
typedef struct FarNode {
  scalar lift; /* above 0 */
  scalar weight[LAYER_QUANTITIES];
} FarNode;

/* What is common to the rays of one wavelength. */
typedef struct LayerRow {
  scalar eye_m;             /* flattened height */
  scalar index_eye;         /* N there */
  scalar lowest_lift_above; /* rays steeper than these never turn on that side */
  scalar lowest_lift_below;
  scalar top_m;    /* where space begins; at the eye or above */
  int level_rises; /* 1: a level ray starts upward */
#if REAL_IS_DOUBLE
  int pad_;
#endif
} LayerRow;

enum { LAYER_STATUS_TURNS = 4 }; /* status byte of a ray: outcome + 2^4 turning points */
