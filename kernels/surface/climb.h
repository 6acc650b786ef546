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

/* One arc within a layer, up to `most` or the layer's edge.
   begin: moved to the arc's end;  step: as of ClimbExit, 0 if it ends inside;  returns: its length in sigma */
DEVICE scalar climb_arc(const AirSlab *slab, scalar bottom, scalar top, scalar most, Climb *begin, scalar *rise,
                        scalar *bend, int *step) {
  const scalar lift = lift_at(slab, begin->z), slope = scalar_root(scalar_magnitude(begin->p));
  scalar sigma = scalar_smaller(most, slab->layer.level_step);
  if (sigma * scalar_root(slope) > slab->layer.steep_step) sigma = slab->layer.steep_step / scalar_root(slope);
  Climb end = climb_on(slab, *begin, lift, sigma);
  if (slab->layer.linear) {
    *rise = begin->p;
    *bend = R(0.5) * lift;
  } else {
    parabola_between(*begin, end, sigma, rise, bend);
  }
  const ClimbExit leaving = leave_layer(*rise, *bend, top - begin->z, bottom - begin->z);
  *step = 0;
  if (leaving.step != 0 && leaving.sigma <= sigma) {
    sigma = leaving.sigma;
    *step = leaving.step;
    end = climb_on(slab, *begin, lift, sigma);
    const scalar edge = leaving.step > 0 ? top : bottom, missed = (edge - end.z) / end.p;
    if (!slab->layer.linear && scalar_magnitude(missed) < R(0.1) * sigma) {
      sigma += missed;
      end.p += missed * lift_at(slab, edge);
    }
    end.z = edge;
    if (end.p * (scalar)leaving.step < R(0)) end.p = R(0);
    if (!slab->layer.linear && sigma > R(0)) parabola_between(*begin, end, sigma, rise, bend);
  }
  *begin = end;
  return sigma;
}

#endif
