/* The distance of the k-th nearest photon, exactly, without a heap: the squared distances below a limit are written
   down, then a value is sought below which there are k, by interpolating in the count and moving from one distance that
   occurs to the next. Where the list is full before the end, the k-th of what it holds becomes the limit, and what is
   not below it is struck out: however steeply the density rises, a few thousand distances are enough. */

typedef struct Survey {
  int count;   /* distances <= limit */
  float below; /* the largest of them */
  float above; /* the smallest beyond */
} Survey;

typedef struct SurveyLanes {
  mask count;
  real below, above;
} SurveyLanes;

DEVICE SurveyLanes survey_nothing(void) {
  const SurveyLanes s = {SPREAD_INT(0), SPREAD(-1), SPREAD(HUGE_F)};
  return s;
}

DEVICE void survey_lanes(SurveyLanes *s, real d2, float limit) {
  const mask within = d2 <= limit;
  s->count += within ? SPREAD_INT(1) : SPREAD_INT(0);
  s->below = larger(s->below, within ? d2 : SPREAD(-1));
  s->above = smaller(s->above, within ? SPREAD(HUGE_F) : d2);
}

DEVICE Survey survey_sum(const SurveyLanes *s) {
  const Survey sum = {lane_count(s->count), lane_largest(s->below), lane_smallest(s->above)};
  return sum;
}

/* A list of squared distances, or, where k of them are too many for one, the map itself. */
typedef struct Distances {
  const PhotonArrays *map;
  const PhotonGrid *grid;
  const Asking *asking;
  int k;
  float limit2;     /* what is not below is not looked at */
  int limit_is_kth; /* limit2 is the k-th of those met so far; fewer than k are below it */
  int count;        /* distances below limit2 */
  mask counts;      /* while they are listed */
  int groups;       /* of LANES distances in the list; more than NEAR_GROUPS: there is no list */
#if NEAR_GROUPS > 0
  real list[NEAR_GROUPS];
#endif
} Distances;

DEVICE Ball ball_of(const Distances *d) {
  const float place_m[3] = {d->asking->x_m, d->asking->y_m, d->asking->z_m};
  return ball_around(d->grid, place_m, scalar_root(d->limit2));
}

/* The map's photons around the place, as a survey. */
DEVICE Survey survey_map(const Distances *d, float limit) {
  const Asking *a = d->asking;
  const Ball ball = ball_of(d);
  SurveyLanes s = survey_nothing();
  for (int row = 0; row < ball.rows; row += LANES) {
    const Rows rows = rows_of_ball(&ball, d->grid, d->map->cell_start, row);
    for (int l = 0; l < LANES; ++l) {
      const int first = LANE_INT(rows.first, l), last = LANE_INT(rows.last, l);
      for (int i = first; i < last && !is_crowded(first, last); i += LANES)
        survey_lanes(&s, distances2(d->map, a, i, LANE_NUMBERS < last - i), limit);
    }
  }
  Crowd among = crowd(0);
  while (next_run(&among, d->map, d->grid, &ball, a->x_m, a->y_m, a->z_m, d->limit2))
    for (int i = among.first; i < among.last; i += LANES)
      survey_lanes(&s, distances2(d->map, a, i, LANE_NUMBERS < among.last - i), limit);
  return survey_sum(&s);
}

DEVICE Survey survey(const Distances *d, float limit) {
#if NEAR_GROUPS > 0
  if (d->groups <= NEAR_GROUPS) {
    SurveyLanes s = survey_nothing();
    for (int g = 0; g < d->groups; ++g) survey_lanes(&s, d->list[g], limit);
    return survey_sum(&s);
  }
#endif
  return survey_map(d, limit);
}

/* Smallest distance^2 that occurs with at least k distances up to it; d->count >= k lie below d->limit2.
   low: fewer than k up to here; high: k or more. After some steps of interpolation the bracket is halved, which ends it
   whatever the distances are. */
DEVICE float select_distance2(const Distances *d) {
  float low = -1, high = d->limit2;
  int count_low = 0, count_high = d->count;
  for (int step = 0;; ++step) {
    const float share = (float)(d->k - count_low) / (float)(count_high - count_low);
    const float from = low < 0 ? 0.0f : low;
    float limit = from + (high - from) * (step >= 12 ? 0.5f : scalar_smaller(share, 0.98f));
    if (!(limit > low && limit < high)) limit = low; /* no number between: high it is */
    const Survey s = survey(d, limit);
    if (s.count >= d->k) {
      high = s.below, count_high = s.count;
      if (s.count == d->k) return high;
    } else {
      if (s.count == d->k - 1 || s.above >= high) return s.above;
      low = limit, count_low = s.count;
    }
  }
}

#if NEAR_GROUPS > 0
/* Makes room in a full list. With k distances in it or more, the k-th is the new limit; what is not below the limit is
   struck out. Where k is so large that this would be done all the time, there is no list from here on. */
DEVICE void strike_out(Distances *d) {
  if (d->k > LANES * NEAR_GROUPS / 2) {
    d->groups = NEAR_GROUPS + 1;
    return;
  }
  d->count = lane_count(d->counts);
  if (d->count >= d->k) {
    d->limit2 = select_distance2(d);
    d->limit_is_kth = 1;
  }
  int kept = 0;
  for (int g = 0; g < d->groups; ++g)
    for (int l = 0; l < LANES; ++l) {
      const float d2 = LANE(d->list[g], l);
      LANE(d->list[kept / LANES], kept % LANES) = d2;
      kept += d2 < d->limit2;
    }
  d->counts = SPREAD_INT(0);
  LANE_INT(d->counts, 0) = kept;
  d->groups = (kept + LANES - 1) / LANES;
  for (int l = kept; l < d->groups * LANES; ++l) LANE(d->list[l / LANES], l % LANES) = HUGE_F;
}
#endif

/* room: groups in the list before it is shortened. limit2, counts and groups are held in registers meanwhile. */
DEVICE void list_run(Distances *d, int first, int last, int room) {
  float limit2 = d->limit2;
  mask counts = d->counts;
  int groups = d->groups;
  for (int i = first; i < last; i += LANES) {
    const real d2 = distances2(d->map, d->asking, i, LANE_NUMBERS < last - i);
    const mask is_near = d2 < limit2;
    counts += is_near ? SPREAD_INT(1) : SPREAD_INT(0);
#if NEAR_GROUPS > 0
    if (groups >= NEAR_GROUPS) continue;
    d->list[groups] = is_near ? d2 : SPREAD(HUGE_F);
    if (++groups < room) continue;
    d->counts = counts, d->groups = groups;
    strike_out(d);
    limit2 = d->limit2, counts = d->counts, groups = d->groups;
#endif
  }
  d->counts = counts;
  d->groups = groups;
}

/* Lists and counts what is nearer than the radius. */
DEVICE void list_distances(Distances *d, float radius_m) {
  const Asking *a = d->asking;
  d->limit2 = scalar_smaller(radius_m * radius_m, HUGE_F);
  d->limit_is_kth = 0;
  d->counts = SPREAD_INT(0);
  d->groups = NEAR_GROUPS > 0 ? 0 : 1;
  const Ball ball = ball_of(d);
  int crowded = 0;
  for (int row = 0; row < ball.rows; row += LANES) {
    const Rows rows = rows_of_ball(&ball, d->grid, d->map->cell_start, row);
    for (int l = 0; l < LANES; ++l) {
      const int first = LANE_INT(rows.first, l), last = LANE_INT(rows.last, l);
      if (is_crowded(first, last)) crowded = 1;
      else list_run(d, first, last, NEAR_GROUPS);
    }
  }
  if (crowded) {
    const int few = 4 * d->k / LANES, room = few < 64 ? 64 : few < NEAR_GROUPS ? few : NEAR_GROUPS;
    Crowd among = crowd(1);
    while (next_run(&among, d->map, d->grid, &ball, a->x_m, a->y_m, a->z_m, d->limit2))
      list_run(d, among.first, among.last, room);
  }
  d->count = lane_count(d->counts);
}

/* Square of the distance of the k-th nearest photon of this side, at most settings->radius_m^2, never 0. Fewer than k
   within radius_m: radius_m^2. *guess_m: where to begin, and afterwards where a near-by question should. */
DEVICE float nearest_radius2(Distances *d, const GatherSettings *settings, float *guess_m) {
  const int k = d->k = settings->nearest;
  float too_small = 0, radius = scalar_smaller(*guess_m, settings->radius_m);
  for (int attempt = 0;; ++attempt) {
    list_distances(d, radius);
    const int is_enough = d->count >= k || d->limit_is_kth;
    if (is_enough && (d->groups <= NEAR_GROUPS || attempt >= 8 || d->count < 4 * k)) {
      const float radius2 = d->count >= k ? select_distance2(d) : d->limit2, guess = 1.08f * scalar_root(radius2);
      *guess_m = guess > 1e-6f * settings->radius_m ? guess : 1e-6f * settings->radius_m;
      return radius2 > 1e-30f ? radius2 : 1e-30f;
    }
    if (!is_enough) {
      if (radius >= settings->radius_m) break;
      too_small = radius;
    }
    const float ratio = scalar_root(1.3f * (float)k / (float)(d->count > 0 ? d->count : 1));
    float next = radius * scalar_smaller(ratio, 4);
    if (!is_enough && next < 1.1f * radius) next = 1.1f * radius;
    if (is_enough && next < too_small) next = 0.5f * (radius + too_small);
    radius = scalar_smaller(next, settings->radius_m);
  }
  *guess_m = settings->radius_m;
  return settings->radius_m * settings->radius_m;
}
