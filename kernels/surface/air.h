/* n^2 of the medium by height, and what it does to a path's height. */

#if AIR_IS_CURVED

/* A layer of one row. */
typedef struct AirSlab {
  AirLayer layer;
  scalar top_m;
  GLOBAL const AirCell *cells;
} AirSlab;

DEVICE int find_air_layer(const Air *air, scalar height_m) {
  int low = 0, high = air->shape.layers - 1;
  while (low < high) {
    const int middle = (low + high + 1) / 2;
    if (air->layers[middle].bottom_m <= height_m) low = middle;
    else high = middle - 1;
  }
  return low;
}

DEVICE AirSlab air_slab(const Air *air, int row, int number) {
  AirSlab s;
  s.layer = air->layers[number];
  s.top_m = number + 1 < air->shape.layers ? air->layers[number + 1].bottom_m : HUGE_BOX_M;
  s.cells = air->cells + (row * air->shape.cells + s.layer.first);
  return s;
}

/* The cell of a height, and where in it; beyond the layer, its edge. */
DEVICE GLOBAL const AirCell *cell_of_height(const AirSlab *s, scalar height_m, scalar *t) {
  const scalar at = (height_m - s->layer.bottom_m) * s->layer.cells_per_m;
  const scalar inside = scalar_smaller(scalar_larger(at, R(0)), (scalar)s->layer.cells);
  int i = (int)inside;
  i = i < s->layer.cells ? i : s->layer.cells - 1;
  *t = inside - (scalar)i;
  return s->cells + i;
}

/* d2z/dsigma2 = (d n^2/dz)/2 [1/m] */
DEVICE scalar lift_at(const AirSlab *s, scalar height_m) {
  scalar t;
  GLOBAL const AirCell *c = cell_of_height(s, height_m, &t);
  return ((R(3) * c->index2[3] * t + R(2) * c->index2[2]) * t + c->index2[1]) * (R(0.5) * s->layer.cells_per_m);
}

DEVICE scalar index2_in_slab(const AirSlab *s, scalar height_m) {
  scalar t;
  GLOBAL const AirCell *c = cell_of_height(s, height_m, &t);
  return ((c->index2[3] * t + c->index2[2]) * t + c->index2[1]) * t + c->index2[0];
}

#endif

/* n^2 of the medium at a height, for wavelength `row`. */
DEVICE scalar air_index2(const Air *air, int row, scalar height_m) {
#if AIR_IS_CURVED
  const AirSlab slab = air_slab(air, row, find_air_layer(air, height_m));
  return index2_in_slab(&slab, height_m);
#else
  (void)height_m;
  return air->cells[row * air->shape.cells].index2[0];
#endif
}
