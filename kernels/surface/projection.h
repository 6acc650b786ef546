/* Caustic photons, aimed by projection maps that are made after bending: traced paths, not lines of sight, mark the
   cells.

   source: Jensen, "Realistic image synthesis using photon mapping" (2001), section 5.4, projection maps
   differs: cells of the emission's random numbers rather than of directions, so that suns and lamps are aimed in place,
   too; and a share of the photons explores all cells, which keeps the estimate unbiased whatever was not marked */

typedef struct Projections {
  GLOBAL const LightProjection *lights;
  GLOBAL const int *cells;      /* lists of marked ones */
  GLOBAL const scalar *weights; /* [lights][PROJECTION_CELLS]: even probability over that of being picked */
} Projections;

/* The word's leading bits from the cell, the others its own. */
DEVICE unsigned int within_cell(unsigned int word, int *cell, int bits) {
  if (bits == 0) return word;
  const unsigned int number = (unsigned int)*cell & ((1u << bits) - 1u);
  *cell >>= bits;
  return number << (32 - bits) | word >> bits;
}

DEVICE void enter_cell(const LightProjection *p, int cell, RandomWords *place, RandomWords *aim) {
  for (int i = 0; i < 2; ++i) aim->word[i] = within_cell(aim->word[i], &cell, p->bits[i]);
  for (int i = 0; i < 3; ++i) place->word[i] = within_cell(place->word[i], &cell, p->bits[2 + i]);
}

/* u: in [0, 1) */
DEVICE int pick_cell(const LightProjection *p, GLOBAL const int *cells, scalar u) {
  if (u < p->explored) return (int)(u / p->explored * (scalar)PROJECTION_CELLS) & (PROJECTION_CELLS - 1);
  const int i = (int)((u - p->explored) / (R(1) - p->explored) * (scalar)p->marked);
  return cells[p->first + (i < p->marked ? i : p->marked - 1)];
}

DEVICE void leave_light(const Geometry *g, const Air *air, const Looks *looks, int light, RandomWords place,
                        RandomWords aim, int alone, Path *path, Bundle *b) {
  for (int w = 0; w < WAVES; ++w) b->weight[w] = looks->spectra[looks->lights[light].power * WAVES + w];
  b->split = WAVES == 1;
  b->hero = (int)(aim.word[3] % (unsigned int)WAVES);
  if (alone) split_bundle(b);
  Vec3 from, direction;
  emit_photon(g, looks, light, place, aim, &from, &direction);
  darken_limb(looks, looks->lights[light].limb, R(unit_interval(aim.word[0])), b);
  begin_path(air, looks, looks->lights[light].glass, b, from, direction, path);
}

/* Photons of a cell, of `samples`, whose first surface is a mirror, glass or rough. */
DEVICE int count_specular(const Geometry *g, const Air *air, const Looks *looks, const PhotonSettings *settings,
                          const LightProjection *projection, int light, int cell, int samples) {
  int found = 0;
  for (int i = 0; i < samples; ++i) {
    const unsigned int id = (unsigned int)((light * PROJECTION_CELLS + cell) * samples + i);
    RandomWords place = photon_words(settings->seed, settings->pass, id, 0, 0);
    RandomWords aim = photon_words(settings->seed, settings->pass, id, 0, 1);
    enter_cell(projection, cell, &place, &aim);
    Path path;
    Bundle b;
    SurfaceHit hit;
    leave_light(g, air, looks, light, place, aim, settings->alone, &path, &b);
    if (trace_to_surface(g, air, &path, &hit) != PATH_SURFACE) continue;
    found += looks->materials[material_of(g, hit.primitive)].kind != MATERIAL_LAMBERT;
  }
  return found;
}

/* From the light over mirrors and glass to the first Lambert surface, where it is stored and ends.
   returns: which of ChunkTally.outcome */
DEVICE int follow_caustic(const Geometry *g, const Air *air, const Looks *looks, const Projections *projections,
                          const PhotonSettings *settings, unsigned int id, const PhotonStore *store,
                          ChunkTally *tally) {
  const int light = light_of_photon(looks, settings->lights, id);
  const LightProjection projection = projections->lights[light];
  RandomWords place = photon_words(settings->seed, settings->pass, id, 0, 0);
  RandomWords aim = photon_words(settings->seed, settings->pass, id, 0, 1);
  const int cell = pick_cell(&projection, projections->cells, R(unit_interval(place.word[3])));
  enter_cell(&projection, cell, &place, &aim);
  Path path;
  Bundle b;
  leave_light(g, air, looks, light, place, aim, settings->alone, &path, &b);
  const scalar share = projections->weights[light * PROJECTION_CELLS + cell] / (scalar)looks->lights[light].photons;
  for (int w = 0; w < WAVES; ++w) b.weight[w] *= share;
  for (int bounce = 1; bounce <= settings->most_bounces; ++bounce) {
    SurfaceHit hit;
    const int outcome = trace_to_surface(g, air, &path, &hit);
    ++tally->bounces;
    if (outcome != PATH_SURFACE) return outcome == PATH_ESCAPED ? 1 : outcome == PATH_NOT_FINITE ? 3 : 2;
    for (int w = 0; w < WAVES; ++w) b.weight[w] *= hit.transmission;
    if (path.glass) absorb_in_glass(looks, path.glass, hit.path_m, &b);
    if (looks->materials[material_of(g, hit.primitive)].kind == MATERIAL_LAMBERT) {
      if (bounce == 1) return 0; /* direct light: the other photons' */
      const Vec3 facing = dot3(hit.normal, hit.momentum) < R(0) ? hit.normal : times(hit.normal, R(-1));
      store_photon(store, tally, &hit, facing, id, bounce, PHOTON_CAUSTIC, &b);
      return 0;
    }
    const RandomWords words = photon_words(settings->seed, settings->pass, id, (unsigned int)bounce, 2);
    const scalar before = bundle_sum(&b);
    if (!scatter_specular(g, air, looks, &hit, words, &path, &b)) return 0;
    if (!survive(&b, before, R(unit_interval(words.word[1])))) return 0;
  }
  return 2;
}
