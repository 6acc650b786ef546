// Damaged files for every reader: it reads them or refuses them in its own words.
#include "fuzz/readers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <regex>

namespace greenray::fuzz {
namespace {

/// A few changes at random: bytes flipped, cut, doubled, moved; words of the format, numbers at their limits put in.
Bytes damaged(const Reader &reader, const std::vector<Bytes> &seeds, std::mt19937 &engine) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : engine() % n; };
  static const std::vector<Bytes> numbers{"0", "-1", "1e38", "-1e308", "4294967296", "nan", "inf", "0x10", "1.", "é"};
  Bytes bytes = seeds[below(seeds.size())];
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
    const std::size_t at = below(bytes.size()), length = 1 + below(std::min<std::size_t>(bytes.size(), 64));
    switch (below(8)) {
      case 0:
        bytes.resize(at);
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes.insert(at, bytes.substr(below(bytes.size()), length));
        break;
      case 3:
        bytes.insert(at, numbers[below(numbers.size())]);
        break;
      case 4:
        if (!reader.words.empty()) bytes.insert(at, reader.words[below(reader.words.size())]);
        break;
      case 5:
        if (!bytes.empty()) bytes[at] = static_cast<char>(engine());
        break;
      case 6:
        if (!bytes.empty()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      default:
        if (!bytes.empty()) bytes.replace(at, length, length, static_cast<char>(below(3) ? 0xff : 0));
        break;
    }
  }
  return bytes;
}

class Readers : public ::testing::TestWithParam<std::size_t> {
 protected:
  const Reader &reader() const { return readers()[GetParam()]; }
};

// oracle: they are good
TEST_P(Readers, ReadTheirSeeds) {
  ASSERT_FALSE(reader().seeds().empty());
  int read = 0;
  for (const Bytes &seed : reader().seeds()) {
    std::string refusal;
    if (feed(reader(), seed, &refusal) == Answer::read) ++read;
    else ADD_FAILURE() << reader().name << ": " << refusal;
  }
  EXPECT_GT(read, 0);
}

// oracle: the promise of every reader: a file is read, or refused with `file:line:column: what was expected` (tables
//         and pictures without lines: at 1:1); no other exception, no signal; with sanitizers no complaint of theirs
TEST_P(Readers, DamagedFilesAreReadOrRefused) {
  std::mt19937 engine(static_cast<unsigned>(GetParam()) + 1);
  const std::vector<Bytes> seeds = reader().seeds();
  const std::regex told("^[^\n]*:[0-9]+:[0-9]+: .*");
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    const Bytes bytes = damaged(reader(), seeds, engine);
    std::string refusal;
    if (feed(reader(), bytes, &refusal) == Answer::read) continue;
    ++refused;
    const std::string first = refusal.substr(0, refusal.find('\n'));
    EXPECT_TRUE(std::regex_match(first, told)) << reader().name << " said: " << first;
  }
  EXPECT_GE(refused, 100) << "of 400";
}

INSTANTIATE_TEST_SUITE_P(Every, Readers, ::testing::Range(std::size_t{0}, readers().size()), [](const auto &reader) {
  std::string name = readers()[reader.param].name;
  name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
  return name;
});

}  // namespace
}  // namespace greenray::fuzz
