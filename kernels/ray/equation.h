/* The ray equation G04 3.4, d/dl (n dr/dl) = grad n, in a vertical plane over a layered medium.

   In flattened height z (medium/height.h) with N = n (1 + h/R), and sigma with d(sigma) = dS/N, eq 3.4 is Hamiltonian:
     dz/dsigma = rise,   d(rise)/dsigma = N^2 (1/R + g(z)),   run constant,   N^2 = run^2 + rise^2,   g = d(ln n)/dz
   and along the way
     surface distance = run sigma,   d(bending)/dsigma = -run g,   d(optical path)/dsigma = N^2,
     d(column)/dsigma = density (1 + h/R) N.
   differs from G04: written for the pair (z, rise), so that nothing of size 1 or of size R is ever differenced in
   float, no sine is needed, and Bouguer's invariant is exact by construction. z is carried as the height above the
   bottom of the ray's cell: its rounding is that of the cell's thickness, a centimetre layer at 3 km is as sharp as one
   on the ground. */

typedef struct RayState {
  real above_m; /* flattened height above the bottom of the cell */
  real rise, bending_rad, optical_path_m;
#if WITH_COLUMNS
  real column[3];
#endif
} RayState;

typedef RayState RaySlope; /* the same quantities per unit of sigma */

typedef struct Medium {
  CellLanes cell; /* of each lane, now */
  real run;
  Absorbers absorbers;
} Medium;

#if WITH_COLUMNS
/* Path densities of air, ozone and aerosol times d(path)/d(sigma). */
DEVICE void column_slope(const Medium *m, real t, real above_m, real momentum2, RaySlope *slope) {
  const real z_m = m->cell.bottom_m + above_m;
  const real path = exponential(z_m * m->absorbers.earth_curvature_per_m) * root(momentum2);
  const real from_peak = (z_m - m->absorbers.ozone_peak_m) / m->absorbers.ozone_width_m;
  slope->column[0] = air_density(&m->cell, t) * path;
  slope->column[1] = exponential(R(-0.5) * from_peak * from_peak) * path;
  slope->column[2] = exponential(-z_m / m->absorbers.aerosol_scale_m) * path;
}
#endif

DEVICE RaySlope derivative(const Medium *m, real above_m, real rise) {
  const real t = above_m / m->cell.thickness_m;
  const real gradient = log_index_gradient(&m->cell, t);
  const real momentum2 = m->run * m->run + rise * rise;
  RaySlope slope;
  slope.above_m = rise;
  slope.rise = momentum2 * (m->absorbers.earth_curvature_per_m + gradient);
  slope.bending_rad = -m->run * gradient;
  slope.optical_path_m = momentum2;
#if WITH_COLUMNS
  column_slope(m, t, above_m, momentum2, &slope);
#endif
  return slope;
}

/* y + h k, for every quantity. */
DEVICE void advance(RayState *y, real h, const RaySlope *k) {
  y->above_m += h * k->above_m;
  y->rise += h * k->rise;
  y->bending_rad += h * k->bending_rad;
  y->optical_path_m += h * k->optical_path_m;
#if WITH_COLUMNS
  for (int i = 0; i < 3; ++i) y->column[i] += h * k->column[i];
#endif
}

/* Error of direction, as an angle [rad]: of rise, of bending, and of height over the step's length. */
DEVICE real direction_error(real dz_m, real drise, real dbending, real h) {
  return larger(larger(magnitude(drise), magnitude(dbending)), magnitude(dz_m) / h);
}
