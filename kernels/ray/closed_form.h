/* The closed form for a medium in layers: no steps, no step control.

   Along a ray N cos(e) is constant, so with lift(z) = 1 - (N_eye/N(z))^2
     sin^2 e(z) = sin^2 e0 + cos^2 e0 lift(z),
   without cancellation however flat the ray, and every quantity of the ray is  integral of w(z) dz / sin e(z).
   In a layer of relative height t let  sin^2 e = line(t) - c t(1-t) + d t(1-t)(t-1/2). With a, b the sines at its edges
   and r = 1/(a+b), these integrals over 0..1 are exact: int line^(-1/2) = 2 r                     int t(1-t)
   line^(-3/2) = 4/3 r^3          int t^2(1-t)^2 line^(-5/2) = 16/15 r^5 int (t-1/2) line^(-1/2) = -(b-a) r^2/3    int
   (t-1/2) t(1-t) line^(-3/2) = -2/5 (b-a) r^4 int (6t^2-6t+1) line^(-1/2) = 2/5 (b-a)^2 r^3 so to second order in c and
   first in d, a few products of r and b - a serve every quantity; one square root and one division a layer. They hold
   for b = 0: a ray that turns inside is integrated to the root of sin^2 e. source: derived here; Auer & Standish,
   Astron. J. 119 (2000) 2472 integrate the same quantity by quadrature. */

/* Factors of mean, tilt and bow of a layer. */
typedef struct LayerFactors {
  real mean, tilt, bow;
} LayerFactors;

DEVICE LayerFactors layer_factors(real near_sine, real far_sine, real c, real d) {
  const real r = R(1) / larger(near_sine + far_sine, SPREAD(R(1e-12)));
  const real rise = (far_sine - near_sine) * r, bulge = c * r * r, skew = d * r * r;
  LayerFactors f;
  f.mean = r * (R(2) + bulge * (R(2.0 / 3) + R(0.4) * bulge) + R(0.2) * skew * rise);
  f.tilt = -r * rise * (R(1.0 / 3) + R(0.2) * bulge);
  f.bow = R(0.4) * r * rise * rise;
  return f;
}

/* sin^2 e along a layer as a polynomial: near2 + t (linear + t (square - t cubic)). */
typedef struct LayerSine {
  real near2, linear, square, cubic;
} LayerSine;

DEVICE LayerSine layer_sine(real near2, real far2, real c, real d) {
  LayerSine s;
  s.near2 = near2;
  s.linear = far2 - near2 - c - R(0.5) * d;
  s.square = c + R(1.5) * d;
  s.cubic = d;
  return s;
}

DEVICE real sine2_at(const LayerSine *s, real t) { return s->near2 + t * (s->linear + t * (s->square - t * s->cubic)); }

/* Factors of the part 0..f alone, made so that they apply to the whole layer's weights. end2: sin^2 e at f. */
DEVICE LayerFactors part_factors(const LayerSine *s, real f, real end2) {
  const real part_d = s->cubic * f * f * f;
  const LayerFactors part = layer_factors(root(larger(s->near2, SPREAD(0))), root(larger(end2, SPREAD(0))),
                                          s->square * f * f - R(1.5) * part_d, part_d);
  /* w(f u) in Legendre's polynomials of u, times dt = f du. */
  const real g = f - R(1);
  LayerFactors whole;
  whole.mean = f * part.mean;
  whole.tilt = f * (R(0.5) * g * part.mean + f * part.tilt);
  whole.bow = f * ((R(2) * f * f - R(3) * f + R(1)) * part.mean + R(6) * f * g * part.tilt + f * f * part.bow);
  return whole;
}

/* Where a layer that a ray cannot cross is left again: the first root of sin^2 e. */
DEVICE real turning_place(const LayerSine *s) {
  const real discriminant = s->linear * s->linear - R(4) * s->near2 * s->square;
  real f = R(2) * s->near2 / larger(root(larger(discriminant, SPREAD(0))) - s->linear, SPREAD(R(1e-30)));
  f = smaller(f, SPREAD(1));
  for (int i = 0; i < 2; ++i) { /* the cubic term, by Newton */
    const real slope = s->linear + f * (R(2) * s->square - R(3) * f * s->cubic);
    const real next = f - sine2_at(s, f) / (slope < R(0) ? slope : SPREAD(-1));
    f = ((slope < R(0)) & (next > R(0)) & (next < R(1))) ? next : f;
  }
  return f;
}

/* Factors of a layer for a ray that crosses it, or, where it turns, of its part up to there; reach: 1, or that place.
 */
DEVICE LayerFactors reached_factors(GLOBAL const Layer *layer, real near2, real far2, real cosine2, mask turns,
                                    real *reach) {
  const real c = cosine2 * layer->bulge, d = cosine2 * layer->skew;
  LayerFactors f = layer_factors(root(larger(near2, SPREAD(0))), root(larger(far2, SPREAD(0))), c, d);
  *reach = SPREAD(1);
  if (any_lane(turns)) {
    const LayerSine s = layer_sine(near2, far2, c, d);
    const real turn = turning_place(&s);
    const LayerFactors t = part_factors(&s, turn, SPREAD(0));
    f.mean = turns ? t.mean : f.mean;
    f.tilt = turns ? t.tilt : f.tilt;
    f.bow = turns ? t.bow : f.bow;
    *reach = turns ? turn : *reach;
  }
  return f;
}

typedef struct LayerSums {
  real value[LAYER_QUANTITIES];
  real end_m; /* flattened height where it turned, or of the last edge */
  mask turned;
} LayerSums;

/* Bending alone where nothing else is wanted: it is the first quantity. */
#if WITH_COLUMNS
#define LAYER_QUANTITIES_SUMMED LAYER_QUANTITIES
#else
#define LAYER_QUANTITIES_SUMMED 1
#endif

DEVICE void add_layer(LayerSums *s, GLOBAL const Layer *layer, LayerFactors f) {
  for (int q = 0; q < LAYER_QUANTITIES_SUMMED; ++q)
    s->value[q] += layer->mean[q] * f.mean + layer->tilt[q] * f.tilt + layer->bow[q] * f.bow;
}

/* The far part of a ray that is steep enough everywhere there: four nodes share one division. */
DEVICE void add_far(LayerSums *s, GLOBAL const FarNode *nodes, int count, real sine2, real cosine2) {
  for (int k = 0; k < count; k += 4) {
    GLOBAL const FarNode *n = nodes + k;
    const real a = root(sine2 + cosine2 * n[0].lift), b = root(sine2 + cosine2 * n[1].lift);
    const real c = root(sine2 + cosine2 * n[2].lift), d = root(sine2 + cosine2 * n[3].lift);
    const real ab = a * b, cd = c * d, inverse = R(1) / (ab * cd);
    const real over_ab = cd * inverse, over_cd = ab * inverse;
    for (int q = 0; q < LAYER_QUANTITIES_SUMMED; ++q)
      s->value[q] +=
          over_ab * (n[0].weight[q] * b + n[1].weight[q] * a) + over_cd * (n[2].weight[q] * d + n[3].weight[q] * c);
  }
}

/* The layers one way from the eye, for rays that may turn in them. */
DEVICE void sum_turning(LayerSums *s, GLOBAL const Layer *layers, int count, real sine2, real cosine2) {
  mask alive = sine2 >= R(0);
  real near2 = sine2;
  for (int k = 0; k < count && any_lane(alive); ++k) {
    GLOBAL const Layer *layer = layers + k;
    const real far2 = sine2 + cosine2 * layer->lift;
    const mask turns = alive & (far2 <= R(0));
    real reach;
    LayerFactors f = reached_factors(layer, near2, far2, cosine2, turns, &reach);
    s->end_m = alive ? s->end_m + reach * (layer->far_m - s->end_m) : s->end_m;
    f.mean = alive ? f.mean : SPREAD(0);
    f.tilt = alive ? f.tilt : SPREAD(0);
    f.bow = alive ? f.bow : SPREAD(0);
    add_layer(s, layer, f);
    s->turned = s->turned | turns;
    alive = alive & !turns;
    near2 = alive ? far2 : SPREAD(1);
  }
}

/* The same for rays too steep to turn: the hot loop. */
DEVICE void sum_straight(LayerSums *s, GLOBAL const Layer *layers, int count, real sine2, real cosine2) {
  real near_sine = root(sine2);
  for (int k = 0; k < count; ++k) {
    GLOBAL const Layer *layer = layers + k;
    const real far_sine = root(sine2 + cosine2 * layer->lift);
    add_layer(s, layer, layer_factors(near_sine, far_sine, cosine2 * layer->bulge, cosine2 * layer->skew));
    near_sine = far_sine;
  }
  s->end_m = count > 0 ? SPREAD(layers[count - 1].far_m) : s->end_m;
}
