/* The paper's stepping: eq 3.4 discretised along the tangent, step size from Richardson extrapolation.
   A step h is made once whole and once as two halves; with a method of order 2 the halves are better by a factor 4, so
     error = |halves - whole| / 3,   result = halves + (halves - whole) / 3  (third order).
   source: G04 section 3.4; differs: G04's text discretises with grad n at the start of the tangent (first order); we
   take grad n half way along it, which costs one more look-up and makes the extrapolated result third order. The two
   results are compared as changes from the start, not as places: in float the rounding of a height would drown their
   difference. */

DEVICE RayState sum(const RayState *a, const RayState *b) {
  RayState y = *a;
  advance(&y, SPREAD(1), b);
  return y;
}

/* Change of state over h: follow the tangent to its middle, look up grad n there, turn. */
DEVICE RayState tangent_step(const Medium *m, const RayState *start, const RaySlope *first, real h) {
  const RayPlace tangent = place_of(first), at = place_after(start, R(0.5) * h, &tangent);
  const RaySlope middle = slope_at(m, &at);
  RayState change = *start;
  advance(&change, SPREAD(-1), start); /* zero of every quantity */
  advance(&change, h, &middle);
  return change;
}

DEVICE RayState richardson_step(const Medium *m, const RayState *start, const RaySlope *first, real h, real *error) {
  const RayState whole = tangent_step(m, start, first, h);
  const RayState first_half = tangent_step(m, start, first, R(0.5) * h);
  const RayState middle = sum(start, &first_half);
  const RaySlope slope = slope_of(m, &middle);
  const RayState second_half = tangent_step(m, &middle, &slope, R(0.5) * h);
  const RayState halves = sum(&first_half, &second_half);

  RayState difference = halves;
  advance(&difference, SPREAD(-1), &whole);
  *error = R(1.0 / 3) * direction_error(difference.above_m, difference.rise, difference.bending_rad, h);
  RayState end = sum(start, &halves);
  advance(&end, SPREAD(R(1.0 / 3)), &difference);
  return end;
}
