/* Unit vectors in 32 bits. The axes are exact both ways.
   pack_direction: octahedral, 16 bits each, error below 0.004 degrees.
   source: Cigolle, Donow, Evangelakos, Mara, McGuire, Meyer, "A survey of efficient representations for independent
   unit vectors", JCGT 3 (2014)
   pack_normal: three components of 10 bits, error below 0.1 degrees: unpacked by shifts alone, for tests of sides. */

DEVICE int nearest_int(float x) { return x < 0 ? (int)(x - 0.5f) : (int)(x + 0.5f); }

DEVICE unsigned int pack_direction(float x, float y, float z) {
  const float sum = scalar_magnitude(x) + scalar_magnitude(y) + scalar_magnitude(z);
  float u = x / sum, v = y / sum;
  if (z < 0) { /* the lower half is folded over the diagonals */
    const float folded_u = (1 - scalar_magnitude(v)) * (u < 0 ? -1.0f : 1.0f);
    v = (1 - scalar_magnitude(u)) * (v < 0 ? -1.0f : 1.0f);
    u = folded_u;
  }
  return (unsigned int)(nearest_int(u * 32767) + 32768) | (unsigned int)(nearest_int(v * 32767) + 32768) << 16;
}

DEVICE void unpack_direction(unsigned int packed, float *x, float *y, float *z) {
  float u = (float)((int)(packed & 0xffffu) - 32768) / 32767.0f, v = (float)((int)(packed >> 16) - 32768) / 32767.0f;
  const float w = 1 - scalar_magnitude(u) - scalar_magnitude(v);
  if (w < 0) {
    const float folded_u = (1 - scalar_magnitude(v)) * (u < 0 ? -1.0f : 1.0f);
    v = (1 - scalar_magnitude(u)) * (v < 0 ? -1.0f : 1.0f);
    u = folded_u;
  }
  const float length = scalar_root(u * u + v * v + w * w);
  *x = u / length, *y = v / length, *z = w / length;
}

DEVICE unsigned int pack_normal(float x, float y, float z) {
  return ((unsigned int)nearest_int(x * 511) & 0x3ffu) | ((unsigned int)nearest_int(y * 511) & 0x3ffu) << 10 |
         ((unsigned int)nearest_int(z * 511) & 0x3ffu) << 20;
}

/* Component 0, 1 or 2; the vector's length may be off by 0.2 %. */
DEVICE float unpack_normal(unsigned int packed, int component) {
  const int high = (int)(packed << (22 - 10 * component));
  return (float)(high >> 22) * (1.0f / 511);
}
