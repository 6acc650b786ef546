/* A whole ray from its two halves: the layers above the eye and those below. A ray that turns comes back along the
   mirror image of its way, so its sums count twice and it goes on to the other side of the eye; one that turns on both
   sides is trapped. */

typedef struct LayerPath {
  LayerSums up, down;
  mask rising, outcome, turning_points;
  real value[LAYER_QUANTITIES];
  real min_z_m, max_z_m, end_sine2;
} LayerPath;

DEVICE void no_layers(LayerSums *s, LayerRow row, real sine2) {
  for (int q = 0; q < LAYER_QUANTITIES; ++q) s->value[q] = SPREAD(0);
  s->end_m = SPREAD(row.eye_m);
  s->sine2 = sine2;
  s->turned = SPREAD_INT(0);
}

DEVICE void sum_side(LayerSums *s, GLOBAL const Layer *layers, int count, scalar lowest_lift, LayerRow row, real sine2,
                     real cosine2) {
  no_layers(s, row, sine2);
  if (any_lane(sine2 + cosine2 * lowest_lift <= R(0))) sum_turning(s, layers, count, sine2, cosine2);
  else sum_straight(s, layers, count, sine2, cosine2);
}

DEVICE void follow_layers(LayerPath *p, GLOBAL const Layer *above, int layers_above, GLOBAL const Layer *below,
                          int layers_below, LayerRow row, real sine, real cosine) {
  const real sine2 = sine * sine, cosine2 = cosine * cosine;
  const mask level_up = SPREAD_INT(row.level_rises) != 0;
  p->rising = (sine > R(0)) | ((sine == R(0)) & level_up);
  sum_side(&p->up, above, layers_above, row.lowest_lift_above, row, sine2, cosine2);
  const mask needs_down = (!p->rising) | p->up.turned;
  if (any_lane(needs_down)) sum_side(&p->down, below, layers_below, row.lowest_lift_below, row, sine2, cosine2);
  else no_layers(&p->down, row, sine2);

  const mask up_turns = p->up.turned, down_turns = p->down.turned;
  const mask both = up_turns & down_turns;
  const mask goes_up = p->rising | down_turns, goes_down = (!p->rising) | up_turns;
  const mask space = goes_up & !up_turns;
  p->outcome = both ? SPREAD_INT(RAY_TRAPPED) : space ? SPREAD_INT(RAY_SPACE) : SPREAD_INT(RAY_GROUND);
  const mask one = SPREAD_INT(1), none = SPREAD_INT(0);
  p->turning_points = ((up_turns & goes_up) ? one : none) + ((down_turns & goes_down) ? one : none);
  const real times_up = goes_up ? (up_turns ? SPREAD(2) : SPREAD(1)) : SPREAD(0);
  const real times_down = goes_down ? (down_turns ? SPREAD(2) : SPREAD(1)) : SPREAD(0);
  for (int q = 0; q < LAYER_QUANTITIES; ++q) p->value[q] = times_up * p->up.value[q] + times_down * p->down.value[q];
  p->max_z_m = goes_up ? p->up.end_m : SPREAD(row.eye_m);
  p->min_z_m = goes_down ? p->down.end_m : SPREAD(row.eye_m);
  p->end_sine2 = space ? p->up.sine2 : p->down.sine2;
}

DEVICE void record_path(const LayerPath *path, LayerRow row, GLOBAL RayEnd *ends, real cosine, int first,
                        int elevations, int rows) {
  LayerPath p = *path;
  for (int i = 0; i < LANES && first + i < elevations; ++i) {
    RayEnd end;
    const int outcome = (int)LANE_INT(p.outcome, i);
    const scalar run = row.index_eye * LANE(cosine, i);
    end.above_m = outcome == RAY_SPACE ? LANE(p.max_z_m, i) : LANE(p.min_z_m, i);
    end.run = run;
    end.rise = 0;
    end.sigma_m = LANE(p.value[LAYER_DISTANCE], i) / row.index_eye; /* distance = run sigma */
    end.bending_rad = LANE(cosine, i) * LANE(p.value[LAYER_BENDING], i);
    end.optical_path_m = LANE(p.value[LAYER_PATH], i);
    for (int k = 0; k < 3; ++k) end.column[k] = LANE(p.value[LAYER_AIR + k], i);
    end.min_z_m = LANE(p.min_z_m, i);
    end.max_z_m = LANE(p.max_z_m, i);
    end.solver_error_rad = 0;
    end.bouguer_drift = 0;
    end.cell = 0;
    end.outcome = LANE(p.value[LAYER_BENDING], i) == LANE(p.value[LAYER_BENDING], i) ? outcome : RAY_NOT_FINITE;
    end.turning_points = (int)LANE_INT(p.turning_points, i);
    end.steps = 0;
    end.rejected = 0;
    ends[(first + i) * rows] = end;
  }
}
