/* The paper's stepping: eq 3.4 discretised along the tangent, step size from Richardson extrapolation.
   A step h is made once whole and once as two halves; with a method of order 2 the halves are better by a factor 4, so
     error = |halves - whole| / 3,   result = halves + (halves - whole) / 3  (third order).
   source: G04 section 3.4; differs: G04's text discretises with grad n at the start of the tangent (first order); we take
   grad n half way along it, which costs one more look-up and makes the extrapolated result third order. */
#ifndef GREENRAY_RICHARDSON_H
#define GREENRAY_RICHARDSON_H

/* Follow the tangent to its middle, look up grad n there, turn. */
DEVICE RayState tangent_step(const Medium *m, const RayState *start, const RaySlope *first, real h) {
  const RaySlope middle =
      derivative(m, start->z_m + R(0.5) * h * first->z_m, start->rise + R(0.5) * h * first->rise);
  RayState end = *start;
  advance(&end, h, &middle);
  return end;
}

DEVICE RayState richardson_step(const Medium *m, const RayState *start, const RaySlope *first, real h, real *error) {
  const RayState whole = tangent_step(m, start, first, h);
  const RayState half = tangent_step(m, start, first, R(0.5) * h);
  const RaySlope slope = derivative(m, half.z_m, half.rise);
  RayState halves = tangent_step(m, &half, &slope, R(0.5) * h);

  const real third = SPREAD(R(1.0 / 3));
  const RayState difference = {halves.z_m - whole.z_m, halves.rise - whole.rise,
                               halves.bending_rad - whole.bending_rad, halves.optical_path_m - whole.optical_path_m
#if WITH_COLUMNS
                               ,
                               {halves.column[0] - whole.column[0], halves.column[1] - whole.column[1],
                                halves.column[2] - whole.column[2]}
#endif
  };
  *error = third * direction_error(difference.z_m, difference.rise, difference.bending_rad, h);
  advance(&halves, third, &difference);
  return halves;
}

#endif
