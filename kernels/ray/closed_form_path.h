/* A whole ray from its two halves: the layers above the eye and those below. A ray that turns comes back along the
   mirror image of its way, so its sums count twice and it goes on to the other side of the eye; one that turns on both
   sides is trapped. */

/* The layers of one wavelength on both sides of the eye. */
typedef struct LayeredAir {
  GLOBAL const Layer *above, *below;
  GLOBAL const FarNode *far; /* beyond the layers above */
  int above_count, below_count, far_count;
  LayerRow row;
} LayeredAir;

typedef struct LayerPath {
  LayerSums up, down;
  mask rising, outcome, turning_points;
  real value[LAYER_QUANTITIES];
  real min_z_m, max_z_m;
} LayerPath;

DEVICE void no_layers(LayerSums *s, LayerRow row) {
  for (int q = 0; q < LAYER_QUANTITIES; ++q) s->value[q] = SPREAD(0);
  s->end_m = SPREAD(row.eye_m);
  s->turned = SPREAD_INT(0);
}

DEVICE void sum_side(LayerSums *s, GLOBAL const Layer *layers, int count, scalar lowest_lift, LayerRow row, real sine2,
                     real cosine2) {
  no_layers(s, row);
  if (any_lane(sine2 + cosine2 * lowest_lift <= R(0))) sum_turning(s, layers, count, sine2, cosine2);
  else sum_straight(s, layers, count, sine2, cosine2);
}

DEVICE void sum_above(LayerSums *s, const LayeredAir *air, real sine2, real cosine2) {
  sum_side(s, air->above, air->above_count, air->row.lowest_lift_above, air->row, sine2, cosine2);
  if (!any_lane(s->turned)) {
    add_far(s, air->far, air->far_count, sine2, cosine2);
    s->end_m = SPREAD(air->row.top_m);
    return;
  }
  LayerSums all = *s; /* nodes mean something for the lanes that get there */
  add_far(&all, air->far, air->far_count, sine2, cosine2);
  for (int q = 0; q < LAYER_QUANTITIES_SUMMED; ++q) s->value[q] = s->turned ? s->value[q] : all.value[q];
  s->end_m = s->turned ? s->end_m : SPREAD(air->row.top_m);
}

DEVICE void follow_layers(LayerPath *p, const LayeredAir *air, real sine, real cosine) {
  const LayerRow row = air->row;
  const real sine2 = sine * sine, cosine2 = cosine * cosine;
  const mask level_up = SPREAD_INT(row.level_rises) != 0;
  p->rising = (sine > R(0)) | ((sine == R(0)) & level_up);
  sum_above(&p->up, air, sine2, cosine2);
  const mask needs_down = (!p->rising) | p->up.turned;
  if (any_lane(needs_down))
    sum_side(&p->down, air->below, air->below_count, row.lowest_lift_below, row, sine2, cosine2);
  else no_layers(&p->down, row);

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
}

/* Bending alone, and how the ray ended: outcome + 16 turning points. */
DEVICE real bending_and_status(const LayerPath *p, real cosine, mask *status) {
  const real bending = cosine * p->value[LAYER_BENDING];
  const mask ended = bending == bending ? p->outcome : SPREAD_INT(RAY_NOT_FINITE);
  *status = ended + (p->turning_points << LAYER_STATUS_TURNS);
  return bending;
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
