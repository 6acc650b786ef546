/* A medium in layers as one eye sees it, for the closed form (kernels/ray/closed_form.h). Built in double by the host
   (host/atmosphere/layer_table.cpp), once for the layers above the eye and once for those below, each starting at the eye. */

enum LayerQuantity {
  LAYER_BENDING = 0,  /* [rad], over cos(e) */
  LAYER_DISTANCE = 1, /* [m], over cos(e) */
  LAYER_PATH = 2,     /* optical path [m] */
  LAYER_AIR = 3,      /* [kg/m^2] */
  LAYER_OZONE = 4,    /* [m] */
  LAYER_AEROSOL = 5,  /* [m] */
  LAYER_QUANTITIES = 6
};

/* One layer, from its near edge (towards the eye, t = 0) to its far edge (t = 1):
     sin^2(e) at t = s_near^2 + (s_far^2 - s_near^2) t - cos^2(e0) bulge t (1 - t)
     weight of a quantity at t = mean + tilt (t - 1/2)                                    */
typedef struct Layer {
  scalar lift;  /* 1 - (N_eye/N_far)^2: sin^2 at the far edge is sin^2(e0) + cos^2(e0) lift */
  scalar bulge;
  scalar far_m; /* flattened height of the far edge */
  scalar spare;
  scalar mean[LAYER_QUANTITIES];
  scalar tilt[LAYER_QUANTITIES];
} Layer;

/* What is common to a row: counts and the eye. */
typedef struct LayerRow {
  scalar eye_m;          /* flattened height */
  scalar index_eye;      /* N at the eye */
  scalar lowest_lift[2]; /* smallest lift above, below: rays steeper than this never turn there */
  int level_rises;       /* 1: a level ray starts upward */
  int pad_;
} LayerRow;
