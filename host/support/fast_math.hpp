// Logarithm and exponential in float, plain arithmetic without branches or calls, so that loops over them vectorise.
#pragma once
#include <bit>
#include <cstdint>

// Hot loops are compiled twice, for AVX2 and for any processor; the one that fits is chosen when the program loads.
// Both give the same bits: no fused multiply-add is used.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define GREENRAY_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define GREENRAY_VECTOR_CLONES
#endif

namespace greenray {

/// x: positive, normal, finite. Absolute error 1e-7 plus rounding of the result.
inline float fast_log2(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  const std::int32_t shifted = bits - 0x3f3504f3;  // sqrt(1/2): the mantissa comes to lie in [0.707, 1.414)
  const std::int32_t exponent = shifted >> 23;
  const float m = std::bit_cast<float>(bits - exponent * (1 << 23));
  const float s = (m - 1.0F) / (m + 1.0F), q = s * s;  // ln m = 2 atanh s
  const float series = 1.0F + q * (0.33333333F + q * (0.2F + q * (0.14285714F + q * 0.11111111F)));
  return static_cast<float>(exponent) + 2.8853901F * s * series;
}

/// x: within -126 .. 127. Relative error 2e-7.
inline float fast_exp2(float x) {
  const float rounded = x + 12582912.0F;  // 1.5 x 2^23: what is left is the nearest whole number
  const float whole = rounded - 12582912.0F;
  const float f = (x - whole) * 0.69314718F;
  const float series =
      1.0F + f * (1.0F + f * (0.5F + f * (0.16666667F + f * (0.041666667F + f * (0.0083333333F + f * 0.0013888889F)))));
  return std::bit_cast<float>(std::bit_cast<std::int32_t>(series) + (static_cast<std::int32_t>(whole) * (1 << 23)));
}

inline float clamped(float x, float low, float high) { return x < low ? low : x > high ? high : x; }

/// exp(x) for x <= 0.
inline float fast_exp_of_negative(float x) { return fast_exp2(x < -87.0F ? -125.5F : x * 1.4426950F); }

/// x^y for x > 0 where the result is a normal float.
inline float fast_pow(float x, float y) { return fast_exp2(y * fast_log2(x)); }

}  // namespace greenray
