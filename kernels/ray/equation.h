/* The ray equation G04 3.4, d/dl (n dr/dl) = grad n, in a vertical plane over a layered medium.

   In flattened height z (medium/height.h) with N = n (1 + h/R), and sigma with d(sigma) = dS/N, eq 3.4 is Hamiltonian:
     dz/dsigma = rise,   d(rise)/dsigma = N^2 (1/R + g(z)),   run constant,   N^2 = run^2 + rise^2,   g = d(ln n)/dz
   and along the way
     surface distance = run sigma,   d(bending)/dsigma = -run g,   d(optical path)/dsigma = N^2,
     d(column)/dsigma = density (1 + h/R) N.
   differs from G04: written for the pair (z, rise), so that nothing of size 1 or of size R is ever differenced in
   float, no sine is needed, and Bouguer's invariant is exact by construction. z is carried as the height above the
   bottom of the ray's cell: its rounding is that of the cell's thickness, a centimetre layer at 3 km is as sharp as one
   on the ground.

   Where the medium varies along the surface (MEDIUM_VARIES) run is driven, too. Let x be the distance along the path of
   the profile, gx = d(ln n)/dx, and ahead = dx/ds, aside = dx/dw the change of x with the ray's own distance s and with
   a displacement w to its side; drift = dw/dsigma. Then
     d(run)/dsigma = N^2 gx ahead,   d(drift)/dsigma = N^2 gx aside - run^2 w/R^2,   N^2 = run^2 + rise^2 + drift^2
     ds/dsigma = run,   dx/dsigma = run ahead + drift aside,   d(bending)/dsigma = -run g + rise gx ahead
   x is the longitude over the great circle of the path (times R): with course c and beam b the cosine and sine of the
   angle from the path to the ray's great circle, cos^2 (latitude) = 1 - b^2 sin^2(s/R), ahead = c/cos^2, aside =
   -b cos(s/R)/cos^2. Left out: (w/R)^2, which is 1e-10 for a ray pushed 60 m aside. run and x are carried as their
   changes from the start and from the edge of the column, so that float does not drown them. */

typedef struct RayState {
  real above_m; /* flattened height above the bottom of the cell */
  real rise, bending_rad, optical_path_m;
#if WITH_COLUMNS
  real column[3];
#endif
#if MEDIUM_VARIES
  real run_change;          /* of run, since the start */
  real along_m, distance_m; /* x from the left edge of the column; s from the start */
  real across_m, drift;     /* w and its slope */
#endif
} RayState;

typedef RayState RaySlope; /* the same quantities per unit of sigma */

/* What a slope depends on. */
typedef struct RayPlace {
  real above_m, rise;
#if MEDIUM_VARIES
  real run_change, along_m, distance_m, across_m, drift;
#endif
} RayPlace;

typedef struct Medium {
  CellLanes cell; /* of each lane, now */
  real run;       /* at the start */
  Absorbers absorbers;
#if MEDIUM_VARIES
  real per_width, factor; /* of the column; of the wavelength */
  real course, beam;
  int sideways; /* does any lane have a beam? */
#endif
} Medium;

#if WITH_COLUMNS
/* Path densities of air, ozone and aerosol times d(path)/d(sigma). */
DEVICE void column_slope(const Medium *m, real density_kg_m3, real above_m, real momentum2, RaySlope *slope) {
  const real z_m = m->cell.bottom_m + above_m;
  const real path = exponential(z_m * m->absorbers.earth_curvature_per_m) * root(momentum2);
  const real from_peak = (z_m - m->absorbers.ozone_peak_m) / m->absorbers.ozone_width_m;
  slope->column[0] = density_kg_m3 * path;
  slope->column[1] = exponential(R(-0.5) * from_peak * from_peak) * path;
  slope->column[2] = exponential(-z_m / m->absorbers.aerosol_scale_m) * path;
}
#endif

#if MEDIUM_VARIES
/* dx/ds and dx/dw at a distance from the start. */
DEVICE void directions_of_x(const Medium *m, real distance_m, real *ahead, real *aside) {
  *ahead = m->course;
  *aside = SPREAD(0);
  if (!m->sideways) return;
  const real angle = distance_m * m->absorbers.earth_curvature_per_m;
  const real latitude_sine = m->beam * sine(angle);
  const real per_cosine2 = R(1) / (R(1) - latitude_sine * latitude_sine);
  *ahead = m->course * per_cosine2;
  *aside = -m->beam * cosine(angle) * per_cosine2;
}

DEVICE RaySlope derivative(const Medium *m, const RayPlace *at) {
  const real curvature = SPREAD(m->absorbers.earth_curvature_per_m);
  const real t = at->above_m / m->cell.thickness_m;
  const SectionPoint medium = section_at(&m->cell, t, at->along_m * m->per_width, m->per_width, m->factor);
  const real run = m->run + at->run_change;
  const real momentum2 = run * run + at->rise * at->rise + at->drift * at->drift;
  real ahead, aside;
  directions_of_x(m, at->distance_m, &ahead, &aside);
  RaySlope slope;
  slope.above_m = at->rise;
  slope.rise = momentum2 * (curvature + medium.up);
  slope.run_change = momentum2 * medium.along * ahead;
  slope.drift = momentum2 * medium.along * aside - run * run * curvature * curvature * at->across_m;
  slope.along_m = run * ahead + at->drift * aside;
  slope.distance_m = run;
  slope.across_m = at->drift;
  slope.bending_rad = at->rise * medium.along * ahead - run * medium.up;
  slope.optical_path_m = momentum2;
#if WITH_COLUMNS
  column_slope(m, section_density(&m->cell, t, medium.u), at->above_m, momentum2, &slope);
#endif
  return slope;
}
#else
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
  column_slope(m, air_density(&m->cell, t), above_m, momentum2, &slope);
#endif
  return slope;
}
#endif

/* The place of a state; and y + h times a sum of slopes. */
DEVICE RayPlace place_of(const RayState *y) {
  RayPlace at;
  at.above_m = y->above_m;
  at.rise = y->rise;
#if MEDIUM_VARIES
  at.run_change = y->run_change;
  at.along_m = y->along_m;
  at.distance_m = y->distance_m;
  at.across_m = y->across_m;
  at.drift = y->drift;
#endif
  return at;
}
DEVICE void add_to_place(RayPlace *sum, scalar weight, const RaySlope *k) {
  sum->above_m += weight * k->above_m;
  sum->rise += weight * k->rise;
#if MEDIUM_VARIES
  sum->run_change += weight * k->run_change;
  sum->along_m += weight * k->along_m;
  sum->distance_m += weight * k->distance_m;
  sum->across_m += weight * k->across_m;
  sum->drift += weight * k->drift;
#endif
}
DEVICE RayPlace place_after(const RayState *y, real h, const RayPlace *slope) {
  RayPlace at;
  at.above_m = y->above_m + h * slope->above_m;
  at.rise = y->rise + h * slope->rise;
#if MEDIUM_VARIES
  at.run_change = y->run_change + h * slope->run_change;
  at.along_m = y->along_m + h * slope->along_m;
  at.distance_m = y->distance_m + h * slope->distance_m;
  at.across_m = y->across_m + h * slope->across_m;
  at.drift = y->drift + h * slope->drift;
#endif
  return at;
}

DEVICE RaySlope slope_at(const Medium *m, const RayPlace *at) {
#if MEDIUM_VARIES
  return derivative(m, at);
#else
  return derivative(m, at->above_m, at->rise);
#endif
}
DEVICE RaySlope slope_of(const Medium *m, const RayState *y) {
  const RayPlace at = place_of(y);
  return slope_at(m, &at);
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
#if MEDIUM_VARIES
  y->run_change += h * k->run_change;
  y->along_m += h * k->along_m;
  y->distance_m += h * k->distance_m;
  y->across_m += h * k->across_m;
  y->drift += h * k->drift;
#endif
}

/* Error of direction, as an angle [rad]: of rise, of bending, and of height over the step's length. */
DEVICE real direction_error(real dz_m, real drise, real dbending, real h) {
  return larger(larger(magnitude(drise), magnitude(dbending)), magnitude(dz_m) / h);
}
