// Philox on the host twin: the published vectors (the device's are in tests/compute).
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "twin/twin.hpp"

namespace greenray {
namespace {

TEST(Philox, GivesThePublishedWords) {
  // oracle: kat_vectors of Random123 for philox4x32 with 10 rounds
  // tolerance: exact
  struct Known {
    std::array<unsigned, 4> counter;
    std::array<unsigned, 2> key;
    std::array<unsigned, 4> words;
  };
  const Known table[] = {{{0, 0, 0, 0}, {0, 0}, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
                         {{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff},
                          {0xffffffff, 0xffffffff},
                          {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
                         {{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
                          {0xa4093822, 0x299f31d0},
                          {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}}};
  for (const Known &k : table) {
    f32::RandomWords counter{};
    for (std::size_t i = 0; i < 4; ++i) counter.word[i] = k.counter[i];
    const f32::RandomWords got = f32::philox(counter, k.key[0], k.key[1]);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(got.word[i], k.words[i]);
  }
}

TEST(Philox, UnitIntervalIsHalfOpenAndEven) {
  // oracle: words 0 and all ones are the ends; the mean of 40000 uniform numbers is 1/2, their variance 1/12
  // tolerance: 4 standard errors
  EXPECT_EQ(f32::unit_interval(0), 0.0f);
  EXPECT_LT(f32::unit_interval(0xffffffffu), 1.0f);
  double sum = 0, squares = 0;
  const int count = 40000;
  for (unsigned i = 0; i < count / 4; ++i) {
    const f32::RandomWords words = f32::philox({{i, 0, 0, 0}}, 7, 11);
    for (unsigned word : words.word) {
      const double x = f32::unit_interval(word);
      sum += x;
      squares += x * x;
    }
  }
  const double mean = sum / count, variance = squares / count - mean * mean;
  EXPECT_NEAR(mean, 0.5, 4 * std::sqrt(1.0 / 12 / count));
  EXPECT_NEAR(variance, 1.0 / 12, 4 * std::sqrt(1.0 / 180 / count));
}

}  // namespace
}  // namespace greenray
