/* The closed form for a medium in layers: no steps, no step control.

   Along a ray N cos(e) is constant, so with lift(z) = 1 - (N_eye/N(z))^2
     sin^2 e(z) = sin^2 e0 + cos^2 e0 lift(z),
   without cancellation however flat the ray, and every quantity of the ray is  integral of w(z) dz / sin e(z).
   In a layer of relative height t let  sin^2 e = linear(t) - c t(1-t)  and  w = mean + tilt (t - 1/2). With a, b the sines
   at its edges and r = 1/(a+b), to first order in c and exactly in everything else,

     integral = mean (2 r + 2/3 c r^3) - tilt (b - a) r^2 / 3

   because  int lin^(-1/2) = 2 r,  int (t-1/2) lin^(-1/2) = -(b-a) r^2/3,  int t(1-t) lin^(-3/2) = 4/3 r^3.
   This holds for b = 0 too: a ray that turns in the layer is integrated to the t where sin^2 e = 0, the root of a quadratic.
   One square root and one division a layer serve all quantities.
   source: derived here; Auer & Standish, Astron. J. 119 (2000) 2472 integrate the same quantity by quadrature. */

typedef struct LayerSums {
  real value[LAYER_QUANTITIES];
  real turn_m;    /* flattened height where it turned */
  real far_sine2; /* sin^2 e at the end */
  mask turned;
} LayerSums;

/* mean and tilt of the part 0..f of a layer: w(t) = mean + tilt (t - 1/2), t = f u. */
DEVICE void add_part(LayerSums *s, const Layer *layer, real near_sine, real far_sine, real bulge, real f, mask alive) {
  const real sum = near_sine + far_sine;
  const real r = R(1) / larger(sum, SPREAD(R(1e-9)));
  const real part_bulge = bulge * f * f;
  const real for_mean = r * (R(2) + R(2.0 / 3) * part_bulge * r * r) * f;
  const real for_tilt = R(-1.0 / 3) * (far_sine - near_sine) * r * r * f * f + for_mean * R(0.5) * (f - R(1));
  for (int q = 0; q < LAYER_QUANTITIES; ++q)
    s->value[q] += alive ? layer->mean[q] * for_mean + layer->tilt[q] * for_tilt : SPREAD(0);
}

/* The layers one way from the eye, for rays that may turn in them. */
DEVICE void sum_turning(LayerSums *s, GLOBAL const Layer *layers, int count, real sine2, real cosine2) {
  real near_sine2 = sine2;
  mask alive = SPREAD(0) == SPREAD(0);
  s->turned = sine2 < R(0); /* none */
  for (int k = 0; k < count && any_lane(alive); ++k) {
    const Layer layer = layers[k];
    const real far_sine2 = sine2 + cosine2 * layer.lift;
    const real bulge = cosine2 * layer.bulge;
    /* near2 + B t + c t^2 = 0, B = far2 - near2 - c: the smaller root, without cancellation. A bulge can also dip below
       zero inside while the far edge is positive: then the root counts as well. */
    const real slope = far_sine2 - near_sine2 - bulge;
    const real discriminant = slope * slope - R(4) * near_sine2 * bulge;
    const mask dips = (far_sine2 > R(0)) & (bulge > R(0)) & (slope < R(0)) & (discriminant > R(0)) &
                      (slope + R(2) * bulge > R(0));
    const mask turns = alive & ((far_sine2 <= R(0)) | dips);
    const real divisor = larger(root(larger(discriminant, SPREAD(0))) - slope, SPREAD(R(1e-30)));
    const real at = smaller(R(2) * near_sine2 / divisor, SPREAD(1));
    const real f = turns ? at : SPREAD(1);
    const real far_sine = turns ? SPREAD(0) : root(larger(far_sine2, SPREAD(0)));
    add_part(s, &layer, root(near_sine2), far_sine, bulge, f, alive);
    const real near_m = k > 0 ? SPREAD(layers[k - 1].far_m) : s->turn_m;
    s->turn_m = turns ? near_m + f * (layer.far_m - near_m) : (alive ? SPREAD(layer.far_m) : s->turn_m);
    s->turned = s->turned | turns;
    alive = alive & !turns;
    near_sine2 = alive ? far_sine2 : SPREAD(R(1));
  }
  s->far_sine2 = near_sine2;
}

/* The same for rays too steep to turn: the hot loop. */
DEVICE void sum_straight(LayerSums *s, GLOBAL const Layer *layers, int count, real sine2, real cosine2) {
  real near_sine = root(sine2);
  real far_sine2 = sine2;
  for (int k = 0; k < count; ++k) {
    GLOBAL const Layer *layer = layers + k;
    far_sine2 = sine2 + cosine2 * layer->lift;
    const real far_sine = root(far_sine2);
    const real r = R(1) / (near_sine + far_sine);
    const real for_mean = r * (R(2) + R(2.0 / 3) * cosine2 * layer->bulge * r * r);
    const real for_tilt = R(-1.0 / 3) * (far_sine - near_sine) * r * r;
    for (int q = 0; q < CLOSED_FORM_QUANTITIES; ++q)
      s->value[q] += layer->mean[q] * for_mean + layer->tilt[q] * for_tilt;
    near_sine = far_sine;
  }
  s->turned = sine2 < R(0);
  s->far_sine2 = far_sine2;
}
