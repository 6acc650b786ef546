/* How a path climbs through the medium: arcs, each one parabola, that follow the path's height as closely as the
   scene's table allows (AirLayer's steps). Path and momentum themselves are carried on by a method of order 4, so that
   what an arc lacks is not handed on. */

#if AIR_IS_CURVED

/* Height and momentum along z. */
typedef struct Climb {
  scalar z, p;
  scalar lift; /* d2z/dsigma2 there */
} Climb;

typedef struct ClimbExit {
  scalar sigma;
  int step; /* +1: through the top, -1: through the bottom, 0: never */
} ClimbExit;

/* When bend sigma^2 + p sigma reaches an edge: to_top >= 0, to_bottom <= 0 [m]. A path that turns before one edge
   leaves by the other. No cancellation: 2 rise/(p + root) where both have the same sign. */
DEVICE ClimbExit leave_layer(scalar p, scalar bend, scalar to_top, scalar to_bottom) {
  const int up = p > R(0) || (p == R(0) && bend > R(0)), still = p == R(0) && bend == R(0);
  const scalar ahead = up ? to_top : to_bottom, behind = up ? to_bottom : to_top;
  const scalar sign = up ? R(1) : R(-1), speed = sign * p, speed2 = speed * speed;
  const scalar reaches = speed2 + R(4) * bend * ahead;
  const int turns = reaches < R(0);
  const scalar sum = speed + scalar_root(turns ? speed2 + R(4) * bend * behind : reaches);
  const scalar above = turns ? sum : R(2) * sign * ahead, below = turns ? R(-2) * sign * bend : sum;
  ClimbExit e;
  e.sigma = below > R(0) ? above / below : (still ? HUGE_BOX_M : R(0)); /* at rest on the edge: pushed through it */
  e.step = still ? 0 : (up != turns ? 1 : -1);
  return e;
}

/* d2z/dsigma2 = lift(z) over a step by Nystrom's method of order 4 for equations without first derivative.
   source: Hairer, Norsett, Wanner, "Solving Ordinary Differential Equations I", section II.14 */
DEVICE Climb climb_on(const AirSlab *slab, Climb at, scalar sigma) {
  Climb end;
  const scalar lift = at.lift;
  scalar middle = lift, last = lift;
  if (!slab->layer.linear) {
    middle = lift_at(slab, at.z + sigma * (R(0.5) * at.p + R(0.125) * sigma * lift));
    last = lift_at(slab, at.z + sigma * (at.p + R(0.5) * sigma * middle));
  }
  end.z = at.z + sigma * (at.p + sigma * (lift + R(2) * middle) * R(1.0 / 6));
  end.p = at.p + sigma * (lift + R(4) * middle + last) * R(1.0 / 6);
  end.lift = last;
  return end;
}

/* The parabola through both ends of a step whose slope changes as the path's does. */
DEVICE void parabola_between(Climb begin, Climb end, scalar sigma, scalar *rise, scalar *bend) {
  const scalar turn = R(0.5) * (end.p - begin.p), inverse = R(1) / sigma;
  *bend = turn * inverse;
  *rise = (end.z - begin.z) * inverse - turn;
}

/* One arc of a path: from where it begins, over `sigma`, to where the path then is. */
typedef struct Rise {
  scalar sigma, rise, bend; /* z = z0 + rise sigma + bend sigma^2 */
  Climb end;
  int step; /* as of ClimbExit; 0 if it ends inside the layer */
} Rise;

/* Onto an edge that a step of a little more or less than its own would reach. */
DEVICE void land_on_edge(scalar edge, scalar more, Climb begin, Rise *r) {
  r->sigma += more;
  r->end.p += more * r->end.lift;
  r->end.z = edge;
  if (r->end.p * (scalar)r->step < R(0)) r->end.p = R(0);
  if (r->sigma > R(0)) parabola_between(begin, r->end, r->sigma, &r->rise, &r->bend);
}

/* Where the layer is bent unevenly: the step first, and what its own parabola says of the edges. */
DEVICE Rise rise_carefully(const AirSlab *slab, scalar bottom, scalar top, scalar most, Climb begin) {
  Rise r;
  r.sigma = most;
  r.step = 0;
  r.end = climb_on(slab, begin, most);
  parabola_between(begin, r.end, most, &r.rise, &r.bend);
  const ClimbExit leaving = leave_layer(r.rise, r.bend, top - begin.z, bottom - begin.z);
  if (leaving.step == 0 || leaving.sigma > most) return r;
  const scalar edge = leaving.step > 0 ? top : bottom;
  r.sigma = leaving.sigma;
  r.step = leaving.step;
  r.end = climb_on(slab, begin, r.sigma);
  const scalar missed = (edge - r.end.z) / r.end.p;
  land_on_edge(edge, scalar_magnitude(missed) < R(0.1) * r.sigma ? missed : R(0), begin, &r);
  return r;
}

/* Is the path between the edges all along its arc? */
DEVICE int stays_inside(const Rise *r, Climb begin, scalar bottom, scalar top) {
  if (!(r->end.z > bottom && r->end.z < top)) return 0;
  if (begin.p * r->end.p > R(0)) return 1;
  const scalar turn = begin.z - R(0.25) * r->rise * r->rise / r->bend;
  return turn > bottom && turn < top;
}

/* A step that cannot come near an edge, were the lift up to twice as large on its way. */
DEVICE int is_far_from_edges(Climb begin, scalar sigma, scalar bottom, scalar top) {
  const scalar reach = R(1.25) * sigma * (scalar_magnitude(begin.p) + sigma * scalar_magnitude(begin.lift));
  return begin.z - reach > bottom && begin.z + reach < top;
}

DEVICE Rise rise_in_linear_layer(scalar bottom, scalar top, scalar most, Climb begin) {
  Rise r;
  r.rise = begin.p;
  r.bend = R(0.5) * begin.lift;
  const ClimbExit leaving = leave_layer(r.rise, r.bend, top - begin.z, bottom - begin.z);
  r.step = leaving.sigma <= most ? leaving.step : 0;
  r.sigma = r.step != 0 ? leaving.sigma : most;
  r.end.z = begin.z + r.sigma * (r.rise + r.sigma * r.bend);
  r.end.p = begin.p + r.sigma * begin.lift;
  r.end.lift = begin.lift;
  if (r.step == 0) return r;
  r.end.z = r.step > 0 ? top : bottom;
  if (r.end.p * (scalar)r.step < R(0)) r.end.p = R(0);
  return r;
}

/* The next arc within a layer, up to `most` or the layer's edge. */
DEVICE Rise next_rise(const AirSlab *slab, scalar bottom, scalar top, scalar most, Climb begin) {
  if (slab->layer.linear) return rise_in_linear_layer(bottom, top, most, begin);
  const scalar slope = scalar_root(scalar_root(scalar_magnitude(begin.p)));
  most = scalar_smaller(most, slab->layer.level_step);
  if (most * slope > slab->layer.steep_step) most = slab->layer.steep_step / slope;
  Rise r;
  r.sigma = most;
  r.step = 0;
  const int is_far = is_far_from_edges(begin, most, bottom, top);
  if (!is_far) {
    const ClimbExit leaving = leave_layer(begin.p, R(0.5) * begin.lift, top - begin.z, bottom - begin.z);
    r.step = leaving.sigma <= most ? leaving.step : 0;
    if (r.step != 0) r.sigma = leaving.sigma;
  }
  r.end = climb_on(slab, begin, r.sigma);
  if (r.step != 0) {
    const scalar edge = r.step > 0 ? top : bottom, missed = (edge - r.end.z) / r.end.p;
    if (!(scalar_magnitude(missed) < R(0.03) * r.sigma)) return rise_carefully(slab, bottom, top, most, begin);
    land_on_edge(edge, missed, begin, &r);
    return r;
  }
  parabola_between(begin, r.end, r.sigma, &r.rise, &r.bend);
  return is_far || stays_inside(&r, begin, bottom, top) ? r : rise_carefully(slab, bottom, top, most, begin);
}

#endif
