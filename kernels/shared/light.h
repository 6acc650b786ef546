/* Where photons come from. Spectral power by wavelength is a row of the spectra table. */

enum LightKind {
  LIGHT_POINT = 0, /* evenly in all directions */
  LIGHT_SPOT = 1,  /* evenly within a cone, from a point */
  LIGHT_AREA = 2,  /* cosine from triangles or a sphere, on the side of the normal */
  LIGHT_SUN = 3    /* a distant disk: all of the scene's disk in its direction is lit */
};

/* Radiance of a disk over its mean at each wavelength: sum over k of row k times mu^k, mu the cosine between a ray and
   the normal of the sphere it comes from. */
#define LIMB_ROWS 6

typedef struct Light {
  int kind;
  int power;           /* row: spectral power [W/nm]; of the sun: through the disk that covers the scene */
  int first_primitive; /* area: into light_primitives, with running areas for their choice */
  int primitives;
  scalar place[3];     /* point, spot; sun: centre of the lit disk */
  scalar radius_m;     /* spot, point: 0; sun: of the lit disk */
  scalar direction[3]; /* unit, of travel: spot's axis, sun's rays */
  scalar versine;      /* 1 - cos of the half angle of the cone; point: 2; sun: of its own angular radius */
  int limb;            /* sun: first of the LIMB_ROWS rows of its limb darkening; 0: an even disk */
  scalar area_m2;
  scalar radiance_share;     /* area: radiance = spectral power times this [1/(m^2 sr)] */
  unsigned int first_photon; /* of a pass: photons first_photon .. of the next light are its own */
  unsigned int photons;
  int glass; /* that it stands in: as in Path */
} Light;

/* One primitive of an area light: number and the areas of all up to and including it, over the light's whole area. */
typedef struct LightPrimitive {
  scalar running_area;
  int primitive;
} LightPrimitive;
