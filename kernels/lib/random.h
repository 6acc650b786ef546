/* Philox 4x32-10: a counter-based generator. The same (key, counter) gives the same four words on every device, lane
   width, work-group size and rank. source: Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3",
   SC11 (2011); known answers in tests. */

typedef struct RandomWords {
  unsigned int word[4];
} RandomWords;

DEVICE unsigned int product_high(unsigned int a, unsigned int b) {
#ifdef __OPENCL_C_VERSION__ /* PoCL's mul_hi multiplies in four parts */
  return (unsigned int)(((ulong)a * (ulong)b) >> 32);
#else
  return (unsigned int)(((unsigned long long)a * b) >> 32);
#endif
}

DEVICE RandomWords philox(RandomWords counter, unsigned int key0, unsigned int key1) {
  for (int round = 0; round < 10; ++round) {
    const unsigned int high0 = product_high(0xD2511F53u, counter.word[0]), low0 = 0xD2511F53u * counter.word[0];
    const unsigned int high1 = product_high(0xCD9E8D57u, counter.word[2]), low1 = 0xCD9E8D57u * counter.word[2];
    counter.word[0] = high1 ^ counter.word[1] ^ key0;
    counter.word[1] = low1;
    counter.word[2] = high0 ^ counter.word[3] ^ key1;
    counter.word[3] = low0;
    key0 += 0x9E3779B9u;
    key1 += 0xBB67AE85u;
  }
  return counter;
}

/* A word as a float in [0, 1): its top 24 bits. */
DEVICE float unit_interval(unsigned int word) { return (float)(word >> 8) * (1.0f / 16777216.0f); }
