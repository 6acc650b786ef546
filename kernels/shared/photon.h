/* A photon where it landed, 32 bytes, and what the map is asked. Only plain types: the host reads this file once, as
   greenray::Photon (host/compute/photon.hpp), whatever the precision of the rays.

   The power of the photons is an array of its own, float power_W[photons][waves], wave fastest: every photon carries
   all `waves` wavelengths of its map; one that dispersion has split off carries 0 in the others.
   An all-zero record is an empty slot: a tracer may hand over an array with holes. */

enum PhotonKind {
  PHOTON_NONE = 0,     /* empty slot: the map leaves it out */
  PHOTON_DIRECT = 1,   /* first landing, straight from its light (however bent) */
  PHOTON_INDIRECT = 2, /* after at least one diffuse bounce */
  PHOTON_CAUSTIC = 3   /* after specular bounces only */
};

typedef struct Photon {
  float place_m[3];
  unsigned int direction; /* of flight, towards the surface: pack_direction (kernels/lib/pack.h) */
  unsigned int normal;    /* of the surface, on the side where it landed: pack_normal */
  unsigned int surface;   /* number of the surface */
  unsigned int id;        /* of its emission within the pass; (id, bounce) is unique and is the tie-break of the sort */
  unsigned int tags;      /* bounce | kind << 16: PHOTON_TAGS */
} Photon;

/* A place that asks how much light lands there: where an eye ray met a surface. */
typedef struct GatherPoint {
  float place_m[3];
  unsigned int normal; /* pack_normal, on the side of the eye */
} GatherPoint;

#define PHOTON_TAGS(bounce, kind) ((unsigned int)(bounce) | (unsigned int)(kind) << 16)
#define PHOTON_BOUNCE(tags) ((tags)&0xffffu)
#define PHOTON_KIND(tags) ((tags) >> 16)
