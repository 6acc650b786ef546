/* The distance of the k-th nearest photon, exactly, without a heap: the squared distances within a guessed radius are
   written down once, then a value is sought below which there are k, by interpolating in the count and moving from one
   distance that occurs to the next. Each look at the list is branch-free. */

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

/* A list of distances, or, where it would be too long, the map itself. */
typedef struct Distances {
  const PhotonArrays *map;
  const PhotonGrid *grid;
  const Asking *asking;
  float radius_m; /* what lies beyond is not looked at */
  int groups;     /* of LANES distances in the list; more than NEAR_GROUPS: there is no list */
#if NEAR_GROUPS > 0
  real list[NEAR_GROUPS];
#endif
} Distances;

/* Writes the list and counts what lies within the radius. */
DEVICE int list_distances(Distances *d) {
  const float radius2 = d->radius_m * d->radius_m;
  mask counts = SPREAD_INT(0);
  d->groups = 0;
  Runs runs = runs_within(d->grid, d->asking->x_m, d->asking->y_m, d->asking->z_m, d->radius_m);
  while (next_run(&runs, d->grid, d->map->cell_start, d->map->sub_start))
    for (int i = runs.first; i < runs.last; i += LANES) {
      const real d2 = distances2(d->map, d->asking, i, LANE_NUMBERS < runs.last - i);
      counts += d2 < radius2 ? SPREAD_INT(1) : SPREAD_INT(0);
#if NEAR_GROUPS > 0
      if (d->groups < NEAR_GROUPS) d->list[d->groups] = d2;
#endif
      ++d->groups;
    }
  return lane_count(counts);
}

DEVICE Survey survey(const Distances *d, float limit) {
  SurveyLanes s = survey_nothing();
#if NEAR_GROUPS > 0
  if (d->groups <= NEAR_GROUPS) {
    for (int g = 0; g < d->groups; ++g) survey_lanes(&s, d->list[g], limit);
    return survey_sum(&s);
  }
#endif
  Runs runs = runs_within(d->grid, d->asking->x_m, d->asking->y_m, d->asking->z_m, d->radius_m);
  while (next_run(&runs, d->grid, d->map->cell_start, d->map->sub_start))
    for (int i = runs.first; i < runs.last; i += LANES)
      survey_lanes(&s, distances2(d->map, d->asking, i, LANE_NUMBERS < runs.last - i), limit);
  return survey_sum(&s);
}

/* Smallest distance^2 that occurs with at least k distances up to it; `total` >= k lie below radius^2.
   low: fewer than k up to here; high: k or more. After some steps of interpolation the bracket is halved, which ends it
   whatever the distances are. */
DEVICE float select_distance2(const Distances *d, int k, int total) {
  float low = -1, high = d->radius_m * d->radius_m;
  int count_low = 0, count_high = total;
  for (int step = 0;; ++step) {
    const float share = (float)(k - count_low) / (float)(count_high - count_low);
    const float from = low < 0 ? 0.0f : low;
    float limit = from + (high - from) * (step >= 12 ? 0.5f : scalar_smaller(share, 0.98f));
    if (!(limit > low && limit < high)) limit = low; /* no number between: high it is */
    const Survey s = survey(d, limit);
    if (s.count >= k) {
      high = s.below, count_high = s.count;
      if (s.count == k) return high;
    } else {
      if (s.count == k - 1 || s.above >= high) return s.above;
      low = limit, count_low = s.count;
    }
  }
}

/* Square of the distance of the k-th nearest photon of this side, at most settings->radius_m^2, never 0. Fewer than k
   within radius_m: radius_m^2. *guess_m: where to begin, and afterwards where a near-by question should. */
DEVICE float nearest_radius2(Distances *d, const GatherSettings *settings, float *guess_m) {
  const int k = settings->nearest;
  float too_small = 0, radius = scalar_smaller(*guess_m, settings->radius_m);
  for (int attempt = 0;; ++attempt) {
    d->radius_m = radius;
    const int count = list_distances(d);
    if (count >= k && (d->groups <= NEAR_GROUPS || attempt >= 8 || count < 4 * k)) {
      const float radius2 = select_distance2(d, k, count), guess = 1.08f * scalar_root(radius2);
      *guess_m = guess > 1e-6f * settings->radius_m ? guess : 1e-6f * settings->radius_m;
      return radius2 > 1e-30f ? radius2 : 1e-30f;
    }
    if (count < k) {
      if (radius >= settings->radius_m) break;
      too_small = radius;
    }
    const float ratio = scalar_root(1.3f * (float)k / (float)(count > 0 ? count : 1));
    float next = radius * scalar_smaller(ratio, 4);
    if (count < k && next < 1.1f * radius) next = 1.1f * radius;
    if (count >= k && next < too_small) next = 0.5f * (radius + too_small);
    radius = scalar_smaller(next, settings->radius_m);
  }
  *guess_m = settings->radius_m;
  return settings->radius_m * settings->radius_m;
}
