/* Irradiance at a place from the photons around it: sum of power times kernel, LANES photons at a time, branch-free.

   source: Jensen, "Realistic image synthesis using photon mapping" (2001): cone filter, discs against leaks; Silverman,
   "Density estimation" (1986): Epanechnikov's kernel in two dimensions
   differs: photons exactly on the edge are outside. For the nearest k the edge is the k-th photon, so k-1 are counted,
   which makes the estimate unbiased: E[(k-1)/(pi r_k^2)] is the density */

#define CONE_K 1.1f
#define PI_F 3.14159265358979f

typedef struct Asking {
  float x_m, y_m, z_m;
  float nx, ny, nz;
  float squash;
  float facing;
} Asking;

DEVICE Asking asking(const GatherPoint *point, const GatherSettings *settings) {
  Asking a;
  a.x_m = point->place_m[0], a.y_m = point->place_m[1], a.z_m = point->place_m[2];
  a.nx = unpack_normal(point->normal, 0);
  a.ny = unpack_normal(point->normal, 1);
  a.nz = unpack_normal(point->normal, 2);
  a.squash = settings->squash;
  a.facing = settings->facing * 511; /* photons' normals are left in units of 1/511 */
  return a;
}

/* Squared distances [m^2] of photons i .. i + LANES - 1; HUGE_F for those of another side or that are not `counted`.
   WITH_SIDES 0: the asking tells no sides apart and its support is a ball. */
DEVICE real distances2(const PhotonArrays *map, const Asking *a, int i, mask counted) {
  const real dx = load_lanes(map->x_m + i) - a->x_m, dy = load_lanes(map->y_m + i) - a->y_m,
             dz = load_lanes(map->z_m + i) - a->z_m;
  const real d2 = (dx * dx + dy * dy) + dz * dz;
#if WITH_SIDES
  const mask normal = load_ints(map->normal + i);
  const real cosine =
      as_reals(normal << 22 >> 22) * a->nx + as_reals(normal << 12 >> 22) * a->ny + as_reals(normal << 2 >> 22) * a->nz;
  const real height = dx * a->nx + dy * a->ny + dz * a->nz;
  return (cosine >= a->facing) & counted ? d2 + a->squash * (height * height) : SPREAD(HUGE_F);
#else
  return counted ? d2 : SPREAD(HUGE_F);
#endif
}

/* The kernel's value, not yet normalised; only asked for d2 < radius2. */
DEVICE real kernel_weight(real d2, float per_radius2, float per_cone) {
#if GATHER_KERNEL == 1
  return R(1) - root(d2) * per_cone;
#elif GATHER_KERNEL == 2
  return R(1) - d2 * per_radius2;
#else
  return SPREAD(1);
#endif
}

/* 1 / integral of the kernel over its disc [1/m^2]. */
DEVICE float kernel_norm(float radius2) {
#if GATHER_KERNEL == 1
  return 1 / ((1 - 2 / (3 * CONE_K)) * PI_F * radius2);
#elif GATHER_KERNEL == 2
  return 2 / (PI_F * radius2);
#else
  return 1 / (PI_F * radius2);
#endif
}

typedef struct Sums {
  real light[WAVES];
  real inner, squares; /* WITH_SPREAD */
  mask counts;
} Sums;

/* Photons i .. i + LANES - 1, as many as are left before `last`. */
DEVICE void add_photons(Sums *sums, const PhotonArrays *map, const Asking *a, int i, int last, float radius2,
                        float per_radius2, float per_cone) {
  const real d2 = distances2(map, a, i, LANE_NUMBERS < last - i);
  const mask inside = d2 < radius2;
  const real weight = inside ? kernel_weight(d2, per_radius2, per_cone) : SPREAD(0);
  sums->counts += inside ? SPREAD_INT(1) : SPREAD_INT(0);
  real power = SPREAD(0);
  for (int w = 0; w < WAVES; ++w) {
    const real wave_power = load_lanes(map->power_W + w * map->stride + i);
    sums->light[w] += weight * wave_power;
    power += wave_power;
  }
#if WITH_SPREAD
  const real inner_weight = kernel_weight(d2, 2 * per_radius2, 1.41421356f * per_cone);
  sums->inner += (d2 < 0.5f * radius2 ? inner_weight : SPREAD(0)) * power;
  sums->squares += (weight * power) * (weight * power);
#endif
}

/* irradiance_W_m2[WAVES]; spread only WITH_SPREAD. Returns the number of photons inside. */
DEVICE int gather_within(const PhotonArrays *map, const PhotonGrid *grid, const Asking *a, float radius2,
                         GLOBAL float *irradiance_W_m2, GatherSpread *spread) {
  const float radius_m = scalar_root(radius2), per_radius2 = 1 / radius2, per_cone = 1 / (CONE_K * radius_m);
  const float place_m[3] = {a->x_m, a->y_m, a->z_m};
  Sums sums;
  for (int w = 0; w < WAVES; ++w) sums.light[w] = SPREAD(0);
  sums.inner = sums.squares = SPREAD(0);
  sums.counts = SPREAD_INT(0);
  const Ball ball = ball_around(grid, place_m, radius_m);
  int crowded = 0;
  for (int row = 0; row < ball.rows; row += LANES) {
    const Rows rows = rows_of_ball(&ball, grid, map->cell_start, row);
    for (int l = 0; l < LANES; ++l) {
      const int first = LANE_INT(rows.first, l), last = LANE_INT(rows.last, l);
      if (is_crowded(first, last)) {
        crowded = 1;
        continue;
      }
      for (int i = first; i < last; i += LANES) add_photons(&sums, map, a, i, last, radius2, per_radius2, per_cone);
    }
  }
  if (crowded) {
    Crowd among = crowd(0);
    while (next_run(&among, map, grid, &ball, a->x_m, a->y_m, a->z_m, radius2))
      for (int i = among.first; i < among.last; i += LANES)
        add_photons(&sums, map, a, i, among.last, radius2, per_radius2, per_cone);
  }
  const float norm = kernel_norm(radius2);
  for (int w = 0; w < WAVES; ++w) irradiance_W_m2[w] = norm * lane_sum(sums.light[w]);
  spread->inner_W_m2 = WITH_SPREAD ? 2 * norm * lane_sum(sums.inner) : 0;
  spread->variance_W2_m4 = WITH_SPREAD ? norm * norm * lane_sum(sums.squares) : 0;
  return lane_count(sums.counts);
}
