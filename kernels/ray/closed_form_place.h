/* Where a ray is after a distance along the surface, in closed form: place, direction, bending, optical path and the
   columns up to there.

   A ray goes out from the eye on one side, comes back mirrored if it turns there, and goes out on the other; one that
   turns on both sides repeats itself, however long its way. So a place is a place on one side's way out, and inside its
   layer the part of the layer up to there has the same closed form as the whole (closed_form.h, part_factors). All
   layers are walked through: nodes know no places. */

/* On one side's way out; quantities and distance as in LayerSums (distance over cos e0). */
typedef struct LayerPlace {
  real value[LAYER_QUANTITIES];
  real z_m, sine2, lift;
} LayerPlace;

DEVICE real part_value(GLOBAL const Layer *layer, LayerFactors f, int q) {
  return layer->mean[q] * f.mean + layer->tilt[q] * f.tilt + layer->bow[q] * f.bow;
}

/* The fraction of a layer after which `distance` is reached. From any guess the ray's own parabola leads on, which has
   no singularity where the ray is level. */
DEVICE real fraction_at(GLOBAL const Layer *layer, const LayerSine *s, real distance, real reach) {
  real f = SPREAD(0), missing = distance;
  for (int i = 0; i < 8; ++i) {
    const real sine2 = larger(sine2_at(s, f), SPREAD(0));
    const real weight = layer->mean[LAYER_DISTANCE] + layer->tilt[LAYER_DISTANCE] * (f - R(0.5)) +
                        layer->bow[LAYER_DISTANCE] * (R(6) * f * (f - R(1)) + R(1));
    const real run = missing / weight;
    const real slope = s->linear + f * (R(2) * s->square - R(3) * f * s->cubic);
    f = f + run * (root(sine2) + R(0.25) * slope * run);
    f = smaller(larger(f, SPREAD(0)), reach);
    missing = distance - part_value(layer, part_factors(s, f, sine2_at(s, f)), LAYER_DISTANCE);
  }
  return f;
}

/* The place at `wanted`, or at the end of that side, whichever comes first. */
DEVICE void find_place(LayerPlace *p, GLOBAL const Layer *layers, int count, real eye_m, real sine2, real cosine2,
                       real wanted) {
  for (int q = 0; q < LAYER_QUANTITIES; ++q) p->value[q] = SPREAD(0);
  p->z_m = eye_m;
  p->lift = SPREAD(0);
  mask open = wanted > R(0);
  real near_lift = SPREAD(0);
  for (int k = 0; k < count && any_lane(open); ++k) {
    GLOBAL const Layer *layer = layers + k;
    const real near2 = larger(sine2 + cosine2 * near_lift, SPREAD(0)), far2 = sine2 + cosine2 * layer->lift;
    const mask turns = open & (far2 <= R(0));
    real reach;
    LayerFactors f = reached_factors(layer, near2, far2, cosine2, turns, &reach);
    const real left = wanted - p->value[LAYER_DISTANCE];
    const mask here = open & (turns | (part_value(layer, f, LAYER_DISTANCE) >= left));
    if (any_lane(here)) {
      const LayerSine s = layer_sine(near2, far2, cosine2 * layer->bulge, cosine2 * layer->skew);
      const real at = fraction_at(layer, &s, left, reach);
      const LayerFactors part = part_factors(&s, at, sine2_at(&s, at));
      f.mean = here ? part.mean : f.mean;
      f.tilt = here ? part.tilt : f.tilt;
      f.bow = here ? part.bow : f.bow;
      reach = here ? at : SPREAD(1);
    }
    for (int q = 0; q < LAYER_QUANTITIES; ++q) p->value[q] += open ? part_value(layer, f, q) : SPREAD(0);
    p->z_m = open ? p->z_m + reach * (layer->far_m - p->z_m) : p->z_m;
    const LayerSine lift = layer_sine(near_lift, SPREAD(layer->lift), SPREAD(layer->bulge), SPREAD(layer->skew));
    p->lift = open ? sine2_at(&lift, reach) : p->lift;
    near_lift = SPREAD(layer->lift);
    open = open & !here;
  }
  p->sine2 = larger(sine2 + cosine2 * p->lift, SPREAD(0));
}

/* One leg of the way out of the four that a ray repeats. */
typedef struct LayerLeg {
  mask upward;   /* on the layers above the eye */
  mask mirrored; /* on the way back */
  mask ended;    /* beyond the end of a side where the ray does not turn */
  real wanted;   /* distance from the eye on that side, on the way out */
  real before[LAYER_QUANTITIES];
  mask turning_points;
} LayerLeg;

DEVICE LayerLeg leg_at(const LayerPath *p, real wanted) {
  real a[LAYER_QUANTITIES], b[LAYER_QUANTITIES];
  for (int q = 0; q < LAYER_QUANTITIES; ++q) {
    a[q] = p->rising ? p->up.value[q] : p->down.value[q];
    b[q] = p->rising ? p->down.value[q] : p->up.value[q];
  }
  const mask a_turns = p->rising ? p->up.turned : p->down.turned, b_turns = p->rising ? p->down.turned : p->up.turned;
  const real to_a = a[LAYER_DISTANCE], to_b = b[LAYER_DISTANCE], period = R(2) * (to_a + to_b);
  const mask repeats = a_turns & b_turns & (period > R(0));
  const real cycles = repeats ? whole_part(wanted / (repeats ? period : SPREAD(1))) : SPREAD(0);
  const real x = wanted - cycles * period;
  const mask first = (x <= to_a) | (!a_turns), second = (!first) & (x <= R(2) * to_a);
  const mask on_a = first | second, third = (!on_a) & ((x <= R(2) * to_a + to_b) | (!b_turns));
  LayerLeg leg;
  leg.upward = on_a ? p->rising : !p->rising;
  leg.mirrored = second | !(on_a | third);
  leg.wanted = first ? x : second ? R(2) * to_a - x : third ? x - R(2) * to_a : R(2) * (to_a + to_b) - x;
  leg.ended = (first & (x > to_a)) | (third & (x > R(2) * to_a + to_b));
  for (int q = 0; q < LAYER_QUANTITIES; ++q)
    leg.before[q] = cycles * R(2) * (a[q] + b[q]) + (first          ? SPREAD(0)
                                                     : on_a | third ? R(2) * a[q]
                                                                    : R(2) * (a[q] + b[q]));
  const mask none = SPREAD_INT(0), one = SPREAD_INT(1), two = SPREAD_INT(2);
  leg.turning_points = (first ? none : on_a | third ? one : two) + (cycles > R(0) ? two : none);
  return leg;
}

/* distance_m along the surface, one per lane. ends: one per lane, `stride` apart. */
DEVICE void place_rays_at(const LayeredAir *air, real sine, real cosine, real distance_m, GLOBAL RayEnd *ends,
                          int stride, int count) {
  LayerPath path;
  follow_layers(&path, air, sine, cosine);
  const real sine2 = sine * sine, cosine2 = cosine * cosine, eye_m = SPREAD(air->row.eye_m);
  const LayerLeg leg = leg_at(&path, distance_m / larger(cosine, SPREAD(R(1e-12))));
  LayerPlace above, below;
  const mask up = leg.upward;
  find_place(&above, air->above, air->above_count, eye_m, sine2, cosine2, up ? leg.wanted : SPREAD(0));
  find_place(&below, air->below, air->below_count, eye_m, sine2, cosine2, up ? SPREAD(0) : leg.wanted);
  real value[LAYER_QUANTITIES];
  for (int q = 0; q < LAYER_QUANTITIES; ++q) {
    const real way = up ? above.value[q] : below.value[q];
    value[q] = leg.before[q] + (leg.mirrored ? -way : way);
  }
  real z_m = up ? above.z_m : below.z_m, lift = up ? above.lift : below.lift;
  const real level_index = air->row.index_eye / root(R(1) - lift);
  const real out = root(up ? above.sine2 : below.sine2) * level_index;
  real rise = up ? (leg.mirrored ? -out : out) : (leg.mirrored ? out : -out);
  real bending = cosine * value[LAYER_BENDING];
  mask outcome = leg.ended ? (up ? SPREAD_INT(RAY_SPACE) : SPREAD_INT(RAY_GROUND)) : SPREAD_INT(RAY_IN_FLIGHT);
  outcome = ((bending == bending) & (rise == rise)) ? outcome : SPREAD_INT(RAY_NOT_FINITE);
  mask turning_points = leg.turning_points;
  for (int i = 0; i < LANES && i < count; ++i) {
    RayEnd end;
    end.above_m = end.min_z_m = end.max_z_m = LANE(z_m, i);
    end.run = air->row.index_eye * LANE(cosine, i);
    end.rise = LANE(rise, i);
    end.sigma_m = LANE(value[LAYER_DISTANCE], i) / air->row.index_eye;
    end.bending_rad = LANE(bending, i);
    end.optical_path_m = LANE(value[LAYER_PATH], i);
    for (int k = 0; k < 3; ++k) end.column[k] = LANE(value[LAYER_AIR + k], i);
    end.solver_error_rad = end.bouguer_drift = 0;
    end.cell = end.steps = end.rejected = 0;
    end.outcome = (int)LANE_INT(outcome, i);
    end.turning_points = (int)LANE_INT(turning_points, i);
    ends[i * stride] = end;
  }
}
