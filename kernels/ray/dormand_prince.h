/* One step of Dormand & Prince 5(4), J. Comp. Appl. Math. 6 (1980) 19-26, table 2; the fifth-order result is kept.
   error: |difference of the two orders| as an angle [rad] (equation.h, direction_error).
   differs: the first-same-as-last evaluation is not carried over, because steps end at knots where the slope may jump.
 */

CONSTANT scalar dp_a[6][6] = {
    {R(1.0 / 5), 0, 0, 0, 0, 0},
    {R(3.0 / 40), R(9.0 / 40), 0, 0, 0, 0},
    {R(44.0 / 45), R(-56.0 / 15), R(32.0 / 9), 0, 0, 0},
    {R(19372.0 / 6561), R(-25360.0 / 2187), R(64448.0 / 6561), R(-212.0 / 729), 0, 0},
    {R(9017.0 / 3168), R(-355.0 / 33), R(46732.0 / 5247), R(49.0 / 176), R(-5103.0 / 18656), 0},
    {R(35.0 / 384), 0, R(500.0 / 1113), R(125.0 / 192), R(-2187.0 / 6784), R(11.0 / 84)}};
CONSTANT scalar dp_error[7] = {R(71.0 / 57600), 0,           R(-71.0 / 16695), R(71.0 / 1920), R(-17253.0 / 339200),
                               R(22.0 / 525),   R(-1.0 / 40)};

DEVICE RayState dormand_prince_step(const Medium *m, const RayState *start, const RaySlope *first, real h,
                                    real *error) {
  RaySlope k[7];
  k[0] = *first;
  for (int stage = 0; stage < 5; ++stage) {
    RayPlace slope = place_of(start);
    add_to_place(&slope, R(-1), start); /* zero of every quantity */
    for (int j = 0; j <= stage; ++j) add_to_place(&slope, dp_a[stage][j], &k[j]);
    const RayPlace at = place_after(start, h, &slope);
    k[stage + 1] = slope_at(m, &at);
  }
  RayState end = *start;
  for (int j = 0; j < 6; ++j) advance(&end, h * dp_a[5][j], &k[j]);
  k[6] = slope_of(m, &end);

  real dz = SPREAD(0), drise = SPREAD(0), dbending = SPREAD(0);
  for (int j = 0; j < 7; ++j) {
    dz += dp_error[j] * k[j].above_m;
    drise += dp_error[j] * k[j].rise;
    dbending += dp_error[j] * k[j].bending_rad;
  }
  *error = direction_error(h * dz, h * drise, h * dbending, h);
#if MEDIUM_VARIES
  real drun = SPREAD(0), ddrift = SPREAD(0);
  for (int j = 0; j < 7; ++j) {
    drun += dp_error[j] * k[j].run_change;
    ddrift += dp_error[j] * k[j].drift;
  }
  *error = larger(*error, h * larger(magnitude(drun), magnitude(ddrift)));
#endif
  return end;
}
