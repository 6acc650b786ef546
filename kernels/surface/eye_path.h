/* What the eye sees along one path: through mirrors and glass to the first Lambert surface, where the photon map is
   asked, and the light of lamps met on the way.

   Weights are of basic radiance L/n^2, which is constant along a path, curved or refracted. */

typedef struct EyeCamera {
  scalar place[3];
  scalar right[3], up[3], ahead[3]; /* unit, square to each other */
  scalar pixel_tangent;             /* of one pixel at the centre */
  scalar centre_column, centre_row;
  unsigned int seed;
  int width, rows;             /* of this band */
  int first_column, first_row; /* of this band in the whole picture */
  int first_sample, samples;   /* of each pixel in this launch */
  int most_bounces;
  int alone; /* as in PhotonSettings */
  int glass; /* as in Path */
} EyeCamera;

/* One path: what it adds by itself, and what it makes of the irradiance at `point`. */
typedef struct EyeSample {
  GatherPoint point; /* only if asks */
  int asks;          /* 1: radiance += weight * irradiance */
  scalar depth_m;    /* along the path to the first surface; 0: none */
  scalar bend_mrad;  /* between the direction of view and the straight line to that surface */
} EyeSample;

DEVICE void start_eye_path(const Air *air, const Looks *looks, const EyeCamera *c, int column, int row, int sample,
                           Path *path, Bundle *b) {
  const RandomWords pixel = {{(unsigned int)column, (unsigned int)row, 0u, 1u}};
  const RandomWords shift = philox(pixel, c->seed, 0x657965u);
  /* The R2 sequence (Roberts 2018), shifted by a random number of the pixel. */
  const scalar x = (scalar)column + unit_interval(shift.word[0] + 3242174889u * (unsigned int)sample);
  const scalar y = (scalar)row + unit_interval(shift.word[1] + 2447445414u * (unsigned int)sample);
  const scalar right = (x - c->centre_column) * c->pixel_tangent, up = (c->centre_row - y) * c->pixel_tangent;
  const Vec3 d = unit3(
      along(along(vec3(c->ahead[0], c->ahead[1], c->ahead[2]), right, vec3(c->right[0], c->right[1], c->right[2])), up,
            vec3(c->up[0], c->up[1], c->up[2])));
  /* Wavelengths of one pixel's paths in golden steps around the spectrum: any few of them cover all of it. */
  b->hero = (int)(((shift.word[2] + 2654435769u * (unsigned int)sample) >> 16) * (unsigned int)WAVES >> 16);
  b->split = WAVES == 1;
  for (int w = 0; w < WAVES; ++w) b->weight[w] = R(1);
  if (c->alone) split_bundle(b);
  begin_path(air, looks, c->glass, b, vec3(c->place[0], c->place[1], c->place[2]), d, path);
  path->measured = 1;
  const scalar index2 = dot3(path->momentum, path->momentum);
  for (int w = 0; w < WAVES; ++w) { /* L = n^2 (L/n^2), at the eye */
    const scalar glass = c->glass ? glass_rows(looks, c->glass)[w] : R(0);
    b->weight[w] *= c->glass ? glass * glass : index2;
  }
}

/* Adds what a lamp shows to the eye: its front only. */
DEVICE void see_lamp(const Geometry *g, const Looks *looks, const SurfaceHit *hit, const Bundle *b, scalar *radiance) {
  const int number = light_of(g, hit->primitive);
  if (number < 0 || !(dot3(hit->normal, hit->momentum) < R(0))) return;
  GLOBAL const Light *light = looks->lights + number;
  const scalar per_index2 = light->radiance_share / dot3(hit->momentum, hit->momentum);
  for (int w = 0; w < WAVES; ++w) radiance[w] += b->weight[w] * looks->spectra[light->power * WAVES + w] * per_index2;
}

/* The weight of the irradiance at a Lambert surface: albedo/(pi n^2). */
DEVICE void ask_map(const Geometry *g, const Looks *looks, const SurfaceHit *hit, const Bundle *b, EyeSample *out,
                    scalar *weight) {
  const Material m = looks->materials[material_of(g, hit->primitive)];
  const Vec3 facing = dot3(hit->normal, hit->momentum) < R(0) ? hit->normal : times(hit->normal, R(-1));
  scalar albedo[WAVES];
  reflectance_at(g, looks, &m, hit, albedo);
  const scalar share = R(0.318309886183790672) / dot3(hit->momentum, hit->momentum);
  for (int w = 0; w < WAVES; ++w) weight[w] = b->weight[w] * albedo[w] * share;
  out->asks = 1;
  out->point.place_m[0] = hit->place.x;
  out->point.place_m[1] = hit->place.y;
  out->point.place_m[2] = hit->place.z;
  out->point.normal = pack_normal(facing.x, facing.y, facing.z);
}

DEVICE void note_first_hit(const Path *start, const SurfaceHit *hit, EyeSample *out) {
  const Vec3 line = unit3(minus(hit->place, start->place)), view = unit3(start->momentum);
  out->depth_m = hit->path_m;
  out->bend_mrad = R(1000) * length3(cross3(line, view));
}

DEVICE void follow_eye_path(const Geometry *g, const Air *air, const Looks *looks, const EyeCamera *c, int column,
                            int row, int sample, EyeSample *out, scalar *radiance, scalar *weight) {
  Path path;
  Bundle b;
  start_eye_path(air, looks, c, column, row, sample, &path, &b);
  const Path start = path;
  out->asks = 0;
  out->depth_m = out->bend_mrad = R(0);
  for (int w = 0; w < WAVES; ++w) radiance[w] = weight[w] = R(0);
  for (int bounce = 1; bounce <= c->most_bounces; ++bounce) {
    SurfaceHit hit;
    if (trace_to_surface(g, air, &path, &hit) != PATH_SURFACE) return;
    if (bounce == 1) note_first_hit(&start, &hit, out);
    for (int w = 0; w < WAVES; ++w) b.weight[w] *= hit.transmission;
    if (path.glass) absorb_in_glass(looks, path.glass, hit.path_m, &b);
    see_lamp(g, looks, &hit, &b, radiance);
    if (looks->materials[material_of(g, hit.primitive)].kind == MATERIAL_LAMBERT) {
      ask_map(g, looks, &hit, &b, out, weight);
      return;
    }
    const RandomWords counter = {
        {(unsigned int)column, (unsigned int)row, (unsigned int)sample, (unsigned int)bounce + 1u}};
    const RandomWords words = philox(counter, c->seed, 0x657965u);
    const scalar before = bundle_sum(&b);
    if (!scatter_specular(g, air, looks, &hit, words, &path, &b)) return;
    if (bounce > 8 && !survive(&b, before, R(unit_interval(words.word[1])))) return;
  }
}
