/* Three scalars in registers, and the scalar functions that geometry needs, for both languages. */

#ifdef __OPENCL_C_VERSION__
#define SCALAR_MATH(name, ours) \
  DEVICE scalar ours(scalar x) { return name(x); }
#else
#define SCALAR_MATH(name, ours) \
  DEVICE scalar ours(scalar x) { return std::name(x); }
#endif
SCALAR_MATH(sqrt, scalar_root)
SCALAR_MATH(fabs, scalar_magnitude)
SCALAR_MATH(sin, scalar_sine)
SCALAR_MATH(cos, scalar_cosine)
SCALAR_MATH(exp, scalar_exponential)
SCALAR_MATH(floor, scalar_floor)

DEVICE scalar scalar_smaller(scalar a, scalar b) { return a < b ? a : b; }
DEVICE scalar scalar_larger(scalar a, scalar b) { return a > b ? a : b; }
DEVICE scalar scalar_within(scalar x, scalar low, scalar high) { return x < low ? low : (x > high ? high : x); }

typedef struct Vec3 {
  scalar x, y, z;
} Vec3;

DEVICE Vec3 vec3(scalar x, scalar y, scalar z) {
  Vec3 v;
  v.x = x;
  v.y = y;
  v.z = z;
  return v;
}
DEVICE Vec3 load_vec3(GLOBAL const scalar *p) { return vec3(p[0], p[1], p[2]); }
DEVICE Vec3 plus(Vec3 a, Vec3 b) { return vec3(a.x + b.x, a.y + b.y, a.z + b.z); }
DEVICE Vec3 minus(Vec3 a, Vec3 b) { return vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
DEVICE Vec3 times(Vec3 a, scalar s) { return vec3(a.x * s, a.y * s, a.z * s); }
/* a + s b */
DEVICE Vec3 along(Vec3 a, scalar s, Vec3 b) { return vec3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z); }
DEVICE scalar dot3(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
DEVICE Vec3 cross3(Vec3 a, Vec3 b) { return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }
DEVICE scalar length3(Vec3 a) { return scalar_root(dot3(a, a)); }
/* The zero vector stays zero. */
DEVICE Vec3 unit3(Vec3 a) {
  const scalar l = length3(a);
  return l > R(0) ? times(a, R(1) / l) : a;
}

/* Two unit vectors that make a right-handed frame (first, second, normal) with a unit normal.
   source: Duff, Burgess, Christensen, Hery, Kensler, Liani, Villemin, "Building an Orthonormal Basis, Revisited",
           JCGT 6(1), 2017 */
DEVICE void frame_around(Vec3 normal, Vec3 *first, Vec3 *second) {
  const scalar sign = normal.z >= R(0) ? R(1) : R(-1);
  const scalar a = R(-1) / (sign + normal.z), b = normal.x * normal.y * a;
  *first = vec3(R(1) + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
  *second = vec3(b, sign + normal.y * normal.y * a, -normal.y);
}
