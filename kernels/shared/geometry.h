/* The scene's surfaces as the device holds them. World frame: metres, z up.

   The tree (built by host/scene/bvh.cpp) has NODE_WIDTH children a node: LANES on CPUs, whose boxes and triangles are
   tested side by side, two on GPUs. Its arrays depend on that width, so they are plain arrays with a layout, not
   structs:
     boxes     [nodes][6][NODE_WIDTH]: low x, low y, low z, high x, high y, high z [m]; a child that is not there is a
               box from +HUGE_BOX_M to -HUGE_BOX_M
     children  [nodes][NODE_WIDTH]: >= 0 a node, else ~(first << 5 | (count - 1) << 1 | kind): count blocks of triangles
               (kind 0) or count spheres (kind 1), from `first` on
     blocks    [blocks][TRIANGLE_SCALARS][LANES], see TriangleScalar
     block_ids [blocks][LANES]: which triangle; -1 fills up a block
   Boxes are grown by GeometryBounds.dilation_m, and so are triangles: a ray aimed at a shared edge or a corner always
   meets one of the neighbours. */

#define NODE_WIDTH (LANES < 2 ? 2 : LANES)
#define HUGE_BOX_M R(1e30)
#define LEAF_KIND_SPHERE 1
#define MOST_LEAF_BLOCKS 16
#define TREE_STACK 128 /* entries; the builder refuses trees that could need more */

/* A place P [m] lies n.P + distance above the plane of the triangle (unit normal n) and has barycentric coordinates
   u = u_row . (P, 1) and v = v_row . (P, 1) of its second and third corner. slack: how far u, v and 1-u-v may be
   negative: dilation_m over the height above the side where each of them is 0. */
enum TriangleScalar {
  TRIANGLE_PLANE = 0, /* n x, n y, n z, distance */
  TRIANGLE_U = 4,
  TRIANGLE_V = 8,
  TRIANGLE_SLACK = 12, /* of u, of v, of 1-u-v */
  TRIANGLE_SCALARS = 15
};

/* Numbers of primitives: triangles first, then spheres. */
typedef struct SurfaceTriangle {
  scalar normal[3]; /* unit, by the right hand over the corners in their order: the outside of closed surfaces */
  scalar area_m2;
  scalar corner[3][3];        /* [corner][xyz] */
  scalar corner_normal[3][3]; /* unit; equal to normal where the mesh has none */
  scalar texture[3][2];       /* u, v of each corner */
  int material;
  int light; /* area light it is part of, or -1 */
} SurfaceTriangle;

typedef struct SurfaceSphere {
  scalar centre[3];
  scalar radius_m;
  int material;
  int light;
} SurfaceSphere;

typedef struct GeometryBounds {
  scalar low[3], high[3]; /* of all surfaces [m] */
  scalar dilation_m;      /* what rounding of places can amount to */
  scalar clearance_m;     /* paths that leave a surface start so far off it */
  int triangles, spheres; /* no primitives at all: the tree is empty and must not be entered */
} GeometryBounds;
