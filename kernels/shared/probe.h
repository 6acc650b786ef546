/* Inputs and outputs of the probe kernel: one evaluation of every device function, for tests against the host twin. */

typedef struct ProbeInput {
  IndexCell cell;
  scalar above_m, run, rise, step_m;
} ProbeInput;

#define PROBE_VALUES 22
typedef struct ProbeOutput {
  scalar value[PROBE_VALUES];
} ProbeOutput;

DEVICE void put(ProbeOutput *out, int *count, real value) { out->value[(*count)++] = LANE(value, 0); }

DEVICE void put_state(ProbeOutput *out, int *count, const RayState *y) {
  put(out, count, y->above_m);
  put(out, count, y->rise);
  put(out, count, y->bending_rad);
  put(out, count, y->optical_path_m);
}

/* The same text on host and device. Every lane carries the same input; lane 0 is reported. */
DEVICE ProbeOutput probe(const ProbeInput *in, Absorbers absorbers) {
  Medium m;
  m.absorbers = absorbers;
  m.run = SPREAD(in->run);
  for (int k = 0; k < 4; ++k) {
    m.cell.gradient[k] = SPREAD(in->cell.gradient[k]);
    m.cell.density[k] = SPREAD(in->cell.density[k]);
  }
  m.cell.bottom_m = SPREAD(in->cell.bottom_m);
  m.cell.thickness_m = SPREAD(in->cell.thickness_m);
  m.cell.log_index = SPREAD(in->cell.log_index);
  m.cell.step_cap_m = SPREAD(in->cell.step_cap_m);
  RayState y;
  y.above_m = SPREAD(in->above_m);
  y.rise = SPREAD(in->rise);
  y.bending_rad = y.optical_path_m = SPREAD(0);
#if WITH_COLUMNS
  y.column[0] = y.column[1] = y.column[2] = SPREAD(0);
#endif
  const real t = y.above_m / m.cell.thickness_m;
  const real h = SPREAD(in->step_m);
  ProbeOutput out;
  int count = 0;
  put(&out, &count, log_index_gradient(&m.cell, t));
  put(&out, &count, log_index_gradient_slope(&m.cell, t));
  put(&out, &count, log_index(&m.cell, t));
  put(&out, &count, air_density(&m.cell, t));
  put(&out, &count, potential(&m, y.above_m));
  const RaySlope slope = derivative(&m, y.above_m, y.rise);
  put_state(&out, &count, &slope);
#if WITH_COLUMNS
  for (int k = 0; k < 3; ++k) put(&out, &count, slope.column[k]);
#endif
  real error;
  RayState end = dormand_prince_step(&m, &y, &slope, h, &error);
  put_state(&out, &count, &end);
  end = richardson_step(&m, &y, &slope, h, &error);
  put_state(&out, &count, &end);
  put(&out, &count, sigma_to_edge(&m, &y, &slope, y.rise > R(0)));
  put(&out, &count, beyond_edge_m(&m.cell, y.rise > R(0), y.above_m));
  return out;
}
