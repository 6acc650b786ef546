/* A photon from its light through the scene: stored wherever it meets a Lambert surface, ended by Russian roulette. */

typedef struct PhotonSettings {
  unsigned int seed, pass;
  unsigned int first;   /* of this launch */
  unsigned int photons; /* of this launch */
  int lights;
  int chunk;        /* photons that one work-item follows */
  int slots;        /* records that it may store in the diffuse map */
  int most_bounces; /* landings after which a photon is dropped */
  int alone;        /* 1: one wavelength a photon from the start: the medium parts them */
  int pad_;
} PhotonSettings;

/* Where power went, summed over a work-item's photons and over the wavelengths [W/nm], and what became of photons. */
enum PhotonTally {
  TALLY_EMITTED = 0,
  TALLY_ABSORBED = 1, /* by surfaces: power before less power after, whether the photon goes on or not */
  TALLY_ESCAPED = 2,
  TALLY_MEDIUM = 3,  /* absorbed on the way, in air or glass */
  TALLY_DROPPED = 4, /* by most_bounces, the cell limit, or a path that is no number */
  TALLY_POWERS = 5
};
typedef struct ChunkTally {
  scalar power[TALLY_POWERS];
  int stored[2];  /* records asked for in the diffuse and the caustic map: more than `slots` means run again */
  int outcome[4]; /* photons by how they ended: absorbed, escaped, dropped, not finite */
  int bounces;    /* path pieces traced */
} ChunkTally;

typedef struct PhotonStore {
  GLOBAL Photon *records[2]; /* of this work-item; diffuse, caustic */
  GLOBAL scalar *power[2];   /* [slots][WAVES] */
  int slots[2];
} PhotonStore;

DEVICE void clear_tally(ChunkTally *t) {
  for (int k = 0; k < TALLY_POWERS; ++k) t->power[k] = R(0);
  for (int k = 0; k < 2; ++k) t->stored[k] = 0;
  for (int k = 0; k < 4; ++k) t->outcome[k] = 0;
  t->bounces = 0;
}

/* Slots that were not needed hold no photon. */
DEVICE void clear_rest(const PhotonStore *store, const ChunkTally *tally) {
  Photon none;
  none.place_m[0] = none.place_m[1] = none.place_m[2] = 0;
  none.direction = none.normal = none.surface = none.id = none.tags = 0;
  for (int map = 0; map < 2; ++map)
    for (int slot = tally->stored[map]; slot < store->slots[map]; ++slot) store->records[map][slot] = none;
}

DEVICE scalar bundle_sum(const Bundle *b) {
  scalar sum = R(0);
  for (int w = 0; w < WAVES; ++w) sum += b->weight[w];
  return sum;
}

DEVICE void store_photon(const PhotonStore *store, ChunkTally *tally, const SurfaceHit *hit, Vec3 facing,
                         unsigned int id, int bounce, int kind, const Bundle *b) {
  const int map = kind == PHOTON_CAUSTIC, slot = tally->stored[map]++;
  if (slot >= store->slots[map]) return;
  const Vec3 d = unit3(hit->momentum);
  Photon photon;
  photon.place_m[0] = hit->place.x;
  photon.place_m[1] = hit->place.y;
  photon.place_m[2] = hit->place.z;
  photon.direction = pack_direction(d.x, d.y, d.z);
  photon.normal = pack_normal(facing.x, facing.y, facing.z);
  photon.surface = (unsigned int)hit->primitive;
  photon.id = id;
  photon.tags = PHOTON_TAGS(bounce, kind);
  store->records[map][slot] = photon;
  for (int w = 0; w < WAVES; ++w) store->power[map][slot * WAVES + w] = b->weight[w];
}

/* Roulette after a loss on the way: as likely as the power that is left of `before`. returns: 0 if it ends */
DEVICE int survive(Bundle *b, scalar before, scalar u) {
  const scalar after = bundle_sum(b);
  if (!(after < before)) return 1;
  const scalar survival = after / before;
  if (!(u < survival)) return 0;
  for (int w = 0; w < WAVES; ++w) b->weight[w] /= survival;
  return 1;
}

/* Off a Lambert surface. returns: 0 if it is absorbed */
DEVICE int bounce_diffusely(const Geometry *g, const Looks *looks, const SurfaceHit *hit, Vec3 facing,
                            RandomWords words, Path *path, Bundle *b) {
  const Material m = looks->materials[material_of(g, hit->primitive)];
  scalar albedo[WAVES];
  reflectance_at(g, looks, &m, hit, albedo);
  if (!roulette(b->weight, albedo, WAVES, R(unit_interval(words.word[0])))) return 0;
  Vec3 first, second;
  frame_around(facing, &first, &second);
  const Vec3 d = from_frame(first, second, facing,
                            sample_cosine(R(unit_interval(words.word[1])), R(unit_interval(words.word[2]))));
  path->place = leave_surface(&g->bounds, hit->place, facing, d);
  path->momentum = times(d, length3(hit->momentum));
  return 1;
}

DEVICE int light_of_photon(const Looks *looks, int lights, unsigned int photon) {
  int i = 0;
  while (i + 1 < lights && photon >= looks->lights[i + 1].first_photon) ++i;
  return i;
}

DEVICE void start_photon(const Geometry *g, const Air *air, const Looks *looks, const PhotonSettings *settings,
                         unsigned int id, Path *path, Bundle *b) {
  const int number = light_of_photon(looks, settings->lights, id);
  const RandomWords place = photon_words(settings->seed, settings->pass, id, 0, 0);
  const RandomWords aim = photon_words(settings->seed, settings->pass, id, 0, 1);
  GLOBAL const Light *light = looks->lights + number;
  for (int w = 0; w < WAVES; ++w) b->weight[w] = looks->spectra[light->power * WAVES + w] / (scalar)light->photons;
  b->split = WAVES == 1;
  b->hero = (int)(aim.word[3] % (unsigned int)WAVES);
  if (settings->alone) split_bundle(b);
  Vec3 from, direction;
  emit_photon(g, looks, number, place, aim, &from, &direction);
  darken_limb(looks, light->limb, R(unit_interval(aim.word[0])), b);
  begin_path(air, looks, light->glass, b, from, direction, path);
}

/* returns: which of ChunkTally.outcome */
DEVICE int follow_photon(const Geometry *g, const Air *air, const Looks *looks, const PhotonSettings *settings,
                         unsigned int id, const PhotonStore *store, ChunkTally *tally) {
  Path path;
  Bundle b;
  start_photon(g, air, looks, settings, id, &path, &b);
  tally->power[TALLY_EMITTED] += bundle_sum(&b);
  int diffuse = 0, specular = 0;
  for (int bounce = 1;; ++bounce) {
    SurfaceHit hit;
    const int outcome = trace_to_surface(g, air, &path, &hit);
    ++tally->bounces;
    scalar before = bundle_sum(&b);
    if (outcome != PATH_SURFACE) {
      tally->power[outcome == PATH_ESCAPED ? TALLY_ESCAPED : TALLY_DROPPED] += before;
      return outcome == PATH_ESCAPED ? 1 : outcome == PATH_NOT_FINITE ? 3 : 2;
    }
    for (int w = 0; w < WAVES; ++w) b.weight[w] *= hit.transmission;
    if (path.glass) absorb_in_glass(looks, path.glass, hit.path_m, &b);
    scalar after = bundle_sum(&b);
    tally->power[TALLY_MEDIUM] += before - after;
    before = after;
    if (bounce > settings->most_bounces) {
      tally->power[TALLY_DROPPED] += before;
      return 2;
    }
    const RandomWords words = photon_words(settings->seed, settings->pass, id, (unsigned int)bounce, 2);
    int goes_on;
    if (looks->materials[material_of(g, hit.primitive)].kind == MATERIAL_LAMBERT) {
      const Vec3 facing = dot3(hit.normal, hit.momentum) < R(0) ? hit.normal : times(hit.normal, R(-1));
      store_photon(store, tally, &hit, facing, id, bounce,
                   diffuse    ? PHOTON_INDIRECT
                   : specular ? PHOTON_CAUSTIC
                              : PHOTON_DIRECT,
                   &b);
      goes_on = bounce_diffusely(g, looks, &hit, facing, words, &path, &b);
      diffuse = 1;
    } else {
      goes_on = scatter_specular(g, air, looks, &hit, words, &path, &b);
      specular = 1;
      if (goes_on) goes_on = survive(&b, before, R(unit_interval(words.word[1])));
    }
    after = goes_on ? bundle_sum(&b) : R(0);
    tally->power[TALLY_ABSORBED] += before - after;
    if (!goes_on) return 0;
  }
}
