/* Masks as bits, one for each lane. */

#ifdef __OPENCL_C_VERSION__
#if LANES == 8
DEVICE int lane_bits(mask m) {
  const int8 bits = m & (int8)(1, 2, 4, 8, 16, 32, 64, 128);
  const int4 half_of = bits.lo | bits.hi;
  const int2 pair = half_of.lo | half_of.hi;
  return pair.x | pair.y;
}
#elif LANES == 4
DEVICE int lane_bits(mask m) {
  int bits = 0;
  for (int i = 0; i < 4; ++i) bits |= LANE_INT(m, i) != 0 ? 1 << i : 0;
  return bits;
}
#else
DEVICE int lane_bits(mask m) { return m != 0; }
#endif
DEVICE int lowest_bit(int bits) { return 31 - (int)clz(bits & -bits); }
#else
DEVICE int lane_bits(mask m) {
  int bits = 0;
  for (int i = 0; i < LANES; ++i) bits |= LANE_INT(m, i) != 0 ? 1 << i : 0;
  return bits;
}
DEVICE int lowest_bit(int bits) { return __builtin_ctz(static_cast<unsigned int>(bits)); }
#endif
