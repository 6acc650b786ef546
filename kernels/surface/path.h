/* Paths among surfaces: what a kernel holds of the scene, a path, and where it ends.

   Set by the build: AIR_IS_CURVED 0: the same n everywhere, straight paths, and no curve code is compiled; 1: chains of
   parabolas. */

#define NO_PRIMITIVE (-1)

enum PathOutcome {
  PATH_SURFACE = 0,
  PATH_ESCAPED = 1, /* left the scene for good */
  PATH_LIMIT = 2,   /* more pieces than allowed: caught in a duct without surfaces */
  PATH_NOT_FINITE = 3,
  PATH_OUTCOMES = 4
};
#define MOST_PATH_ARCS 4096

/* The scene as a kernel holds it. */
typedef struct Geometry {
  GLOBAL const scalar *boxes;
  GLOBAL const int *children;
  GLOBAL const scalar *blocks;
  GLOBAL const int *block_ids;
  GLOBAL const SurfaceTriangle *triangles;
  GLOBAL const SurfaceSphere *spheres;
  GeometryBounds bounds;
} Geometry;

typedef struct Air {
  GLOBAL const AirLayer *layers; /* [shape.layers], upwards */
  GLOBAL const AirCell *cells;   /* [rows][shape.cells] */
  AirShape shape;
} Air;

/* momentum: n times the unit direction of travel, so that its length is n and horizontal parts never change. */
typedef struct Path {
  Vec3 place;
  Vec3 momentum;
  int row; /* of the air's table: which wavelength */
  /* The glass it is in, where it is straight and its momentum's length is the glass's n: 1 + number of the material,
     and 65536 times the same of a glass around that one. 0: the medium. */
  int glass;
  int measured; /* 1: its length is asked for, though nothing is absorbed on the way */
} Path;

typedef struct SurfaceHit {
  int primitive;       /* NO_PRIMITIVE unless PATH_SURFACE; triangles first, then spheres */
  scalar u, v;         /* barycentric, of the second and third corner; spheres: 0 */
  Vec3 place;          /* on the surface [m] */
  Vec3 normal;         /* unit, the surface's own side (not turned towards the path) */
  Vec3 momentum;       /* n times the direction of arrival: n^2 = dot(momentum, momentum) for basic radiance L/n^2 */
  scalar path_m;       /* length along the curve, if measured or needed */
  scalar transmission; /* of power, through the medium on the way */
} SurfaceHit;

/* How a kernel takes the scene: the arguments, and the Geometry made of them. Bound by host/compute/surface_scene. */
#define GEOMETRY_BUFFERS                                                                                            \
  GLOBAL const scalar *boxes, GLOBAL const int *children, GLOBAL const scalar *blocks, GLOBAL const int *block_ids, \
      GLOBAL const SurfaceTriangle *triangles, GLOBAL const SurfaceSphere *spheres, const GeometryBounds bounds
#define GEOMETRY_OF_BUFFERS \
  { boxes, children, blocks, block_ids, triangles, spheres, bounds }
#define AIR_BUFFERS GLOBAL const AirLayer *air_layers, GLOBAL const AirCell *air_cells, const AirShape air_shape
#define AIR_OF_BUFFERS \
  { air_layers, air_cells, air_shape }
