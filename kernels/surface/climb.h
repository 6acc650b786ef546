/* How a path climbs through the medium: arcs, each one parabola, that follow the path's height as closely as the
   scene's table allows (AirLayer's steps). Path and momentum themselves are carried on by a method of order 4, so that
   what an arc lacks is not handed on. */

#if AIR_IS_CURVED

/* Height and momentum along z. */
typedef struct Climb {
  scalar z, p;
} Climb;

typedef struct ClimbExit {
  scalar sigma;
  int step; /* +1: through the top, -1: through the bottom, 0: never */
} ClimbExit;

/* When bend sigma^2 + p sigma reaches an edge: to_top >= 0, to_bottom <= 0 [m]. A path that turns before one edge
   leaves by the other. No cancellation: 2 rise/(p + root) where both have the same sign. */
DEVICE ClimbExit leave_layer(scalar p, scalar bend, scalar to_top, scalar to_bottom) {
  ClimbExit e;
  const int up = p > R(0) || (p == R(0) && bend > R(0));
  const scalar ahead = up ? to_top : to_bottom, behind = up ? to_bottom : to_top;
  const scalar sign = up ? R(1) : R(-1), speed = sign * p;
  const scalar reaches = speed * speed + R(4) * bend * ahead;
  if (p == R(0) && bend == R(0)) {
    e.sigma = HUGE_BOX_M;
    e.step = 0;
  } else if (reaches >= R(0)) {
    const scalar sum = speed + scalar_root(reaches);
    e.sigma = sum > R(0) ? R(2) * sign * ahead / sum : R(0); /* at rest on the edge, pushed through it */
    e.step = up ? 1 : -1;
  } else {
    e.sigma = (speed + scalar_root(speed * speed + R(4) * bend * behind)) / (R(-2) * sign * bend);
    e.step = up ? -1 : 1;
  }
  return e;
}

/* d2z/dsigma2 = lift(z) over a step by Nystrom's method of order 4 for equations without first derivative.
   lift: at the start.  source: Hairer, Norsett, Wanner, "Solving Ordinary Differential Equations I", section II.14 */
DEVICE Climb climb_on(const AirSlab *slab, Climb at, scalar lift, scalar sigma) {
  Climb end;
  scalar middle = lift, last = lift;
  if (!slab->layer.linear) {
    middle = lift_at(slab, at.z + sigma * (R(0.5) * at.p + R(0.125) * sigma * lift));
    last = lift_at(slab, at.z + sigma * (at.p + R(0.5) * sigma * middle));
  }
  end.z = at.z + sigma * (at.p + sigma * (lift + R(2) * middle) * R(1.0 / 6));
  end.p = at.p + sigma * (lift + R(4) * middle + last) * R(1.0 / 6);
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
DEVICE void land_on_edge(const AirSlab *slab, scalar edge, scalar more, Climb begin, Rise *r) {
  r->sigma += more;
  r->end.p += more * lift_at(slab, edge);
  r->end.z = edge;
  if (r->end.p * (scalar)r->step < R(0)) r->end.p = R(0);
  if (r->sigma > R(0)) parabola_between(begin, r->end, r->sigma, &r->rise, &r->bend);
}

/* Where the layer is bent unevenly: the step first, and what its own parabola says of the edges. */
DEVICE Rise rise_carefully(const AirSlab *slab, scalar bottom, scalar top, scalar most, Climb begin, scalar lift) {
  Rise r;
  r.sigma = most;
  r.step = 0;
  r.end = climb_on(slab, begin, lift, most);
  parabola_between(begin, r.end, most, &r.rise, &r.bend);
  const ClimbExit leaving = leave_layer(r.rise, r.bend, top - begin.z, bottom - begin.z);
  if (leaving.step == 0 || leaving.sigma > most) return r;
  const scalar edge = leaving.step > 0 ? top : bottom;
  r.sigma = leaving.sigma;
  r.step = leaving.step;
  r.end = climb_on(slab, begin, lift, r.sigma);
  const scalar missed = (edge - r.end.z) / r.end.p;
  land_on_edge(slab, edge, scalar_magnitude(missed) < R(0.1) * r.sigma ? missed : R(0), begin, &r);
  return r;
}

/* Is the path between the edges all along its arc? */
DEVICE int stays_inside(const Rise *r, Climb begin, scalar bottom, scalar top) {
  if (!(r->end.z > bottom && r->end.z < top)) return 0;
  if (begin.p * r->end.p > R(0)) return 1;
  const scalar turn = begin.z - R(0.25) * r->rise * r->rise / r->bend;
  return turn > bottom && turn < top;
}

/* The next arc within a layer, up to `most` or the layer's edge. */
DEVICE Rise next_rise(const AirSlab *slab, scalar bottom, scalar top, scalar most, Climb begin) {
  Rise r;
  const scalar lift = lift_at(slab, begin.z);
  r.rise = begin.p;
  r.bend = R(0.5) * lift;
  const ClimbExit leaving = leave_layer(begin.p, r.bend, top - begin.z, bottom - begin.z);
  r.sigma = most;
  if (!slab->layer.linear) {
    r.sigma = scalar_smaller(most, slab->layer.level_step);
    const scalar slope = scalar_root(scalar_root(scalar_magnitude(begin.p)));
    if (r.sigma * slope > slab->layer.steep_step) r.sigma = slab->layer.steep_step / slope;
  }
  most = r.sigma;
  r.step = leaving.sigma <= most ? leaving.step : 0;
  if (r.step != 0) r.sigma = leaving.sigma;
  r.end = climb_on(slab, begin, lift, r.sigma);
  const scalar edge = r.step > 0 ? top : bottom;
  if (slab->layer.linear) {
    if (r.step == 0) return r;
    r.end.z = edge;
    if (r.end.p * (scalar)r.step < R(0)) r.end.p = R(0);
    return r;
  }
  if (r.step != 0) {
    const scalar missed = (edge - r.end.z) / r.end.p;
    if (!(scalar_magnitude(missed) < R(0.03) * r.sigma)) return rise_carefully(slab, bottom, top, most, begin, lift);
    land_on_edge(slab, edge, missed, begin, &r);
    return r;
  }
  parabola_between(begin, r.end, r.sigma, &r.rise, &r.bend);
  return stays_inside(&r, begin, bottom, top) ? r : rise_carefully(slab, bottom, top, most, begin, lift);
}

#endif
