// What photons draw: distributions by chi-square on host and device, packing, Fresnel, roulette without bias.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "compute/sampling_probe.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

using namespace photon_twin;
using Samples = std::vector<std::array<float, 3>>;
constexpr double pi = std::numbers::pi;
constexpr std::size_t drawn = 400000;

/// Sum of (seen - expected)^2/expected over the bins; probabilities that add up to 1.
double chi_square(const std::vector<int> &seen, const std::vector<double> &probability, std::size_t count) {
  double sum = 0;
  for (std::size_t b = 0; b < seen.size(); ++b) {
    const double expected = probability[b] * static_cast<double>(count);
    sum += (seen[b] - expected) * (seen[b] - expected) / expected;
  }
  return sum;
}

/// A chi-square of n degrees of freedom stays below this but once in 1e7 (Wilson & Hilferty 1931: its cube root is
/// normal).
double chi_square_limit(std::size_t n) {
  const double d = 2.0 / (9.0 * static_cast<double>(n));
  return static_cast<double>(n) * std::pow(1 - d + 5.2 * std::sqrt(d), 3);
}

/// Holds samples against a density by its two marginal cumulative functions, which must be independent: `rows` bins of
/// the first, `columns` of the second, all equally likely.
void expect_uniform(const Samples &samples, const std::function<double(const std::array<float, 3> &)> &first,
                    const std::function<double(const std::array<float, 3> &)> &second) {
  constexpr int rows = 20, columns = 24;
  std::vector<int> seen(rows * columns);
  for (const auto &s : samples) {
    const int row = std::clamp(static_cast<int>(rows * first(s)), 0, rows - 1);
    const int column = std::clamp(static_cast<int>(columns * second(s)), 0, columns - 1);
    ++seen[static_cast<std::size_t>(row * columns + column)];
  }
  const std::vector<double> even(seen.size(), 1.0 / static_cast<double>(seen.size()));
  EXPECT_LT(chi_square(seen, even, samples.size()), chi_square_limit(seen.size() - 1));
}

/// Angle about z, as a share of the circle.
double turn(const std::array<float, 3> &s) {
  const double t = std::atan2(static_cast<double>(s[1]), static_cast<double>(s[0])) / (2 * pi);
  return t < 0 ? t + 1 : t;
}

class Sampling : public ::testing::TestWithParam<bool> {
 protected:
  Samples draw(SampleKind kind, float parameter, std::size_t count = drawn) const {
    return GetParam() ? device_samples(shared_device(), kind, parameter, count, 77)
                      : host_samples(kind, parameter, count, 77);
  }
};
INSTANTIATE_TEST_SUITE_P(HostAndDevice, Sampling, ::testing::Values(false, true),
                         [](const auto &which) { return which.param ? "device" : "host"; });

// oracle: areas and solid angles in closed form: cumulative functions r^2; sin^2; (1 - cos)/versine; barycentric areas
// tolerance: chi-square of 480 bins, probability 1e-7 of a false alarm
TEST_P(Sampling, DirectionsHaveTheirDensities) {
  const auto squared = [](const std::array<float, 3> &s) {
    return static_cast<double>(s[0]) * static_cast<double>(s[0]) +
           static_cast<double>(s[1]) * static_cast<double>(s[1]);
  };
  expect_uniform(draw(SAMPLE_DISC, 0), squared, turn);
  expect_uniform(draw(SAMPLE_COSINE, 0), squared, turn);
  for (float versine : {2.0f, 0.3f, 1e-5f}) {
    const double from_sine = static_cast<double>(versine);
    expect_uniform(
        draw(SAMPLE_CONE, versine),
        [&](const std::array<float, 3> &s) {
          const double sine2 = squared(s), z = static_cast<double>(s[2]);
          // 1 - cos without cancellation: sin^2/(1 + cos)
          return (z > 0 ? sine2 / (1 + z) : 1 - z) / from_sine;
        },
        turn);
  }
  expect_uniform(
      draw(SAMPLE_TRIANGLE, 0),
      [](const std::array<float, 3> &s) { return std::pow(static_cast<double>(s[0]) + static_cast<double>(s[1]), 2); },
      [](const std::array<float, 3> &s) {
        return static_cast<double>(s[1]) / (static_cast<double>(s[0]) + static_cast<double>(s[1]));
      });
}

TEST_P(Sampling, DirectionsAreUnit) {
  // oracle: a direction has length 1
  // tolerance: six roundings of float
  for (auto [kind, parameter] :
       {std::pair{SAMPLE_COSINE, 0.0f}, {SAMPLE_CONE, 2.0f}, {SAMPLE_CONE, 1e-5f}, {SAMPLE_GGX, 0.3f}})
    for (const auto &s : draw(kind, parameter, 10000)) {
      const double l = std::hypot(static_cast<double>(s[0]), static_cast<double>(s[1]), static_cast<double>(s[2]));
      ASSERT_NEAR(l, 1, 4e-7);
      ASSERT_GE(s[2], kind == SAMPLE_CONE ? -1.0f : 0.0f);
    }
}

// oracle: visible normals' density G1(v) max(0, v.h) D(h) / v.z, written down here, integrated over bins in double
// tolerance: chi-square of some 200 bins, probability 1e-7 of a false alarm
TEST_P(Sampling, GgxNormalsAreThoseSeen) {
  const double view[3] = {std::sqrt(0.75), 0, 0.5};
  for (double alpha : {0.15, 0.5, 1.0}) {
    const auto density = [&](double z, double phi) {
      const double sine = std::sqrt(std::max(0.0, 1 - z * z));
      const double dot = view[0] * sine * std::cos(phi) + view[2] * z;
      const double tangent2 = (1 - view[2] * view[2]) / (view[2] * view[2]);
      const double g1 = 2 / (1 + std::sqrt(1 + alpha * alpha * tangent2));
      const double d = z * z * (alpha * alpha - 1) + 1;
      return g1 * std::max(0.0, dot) * alpha * alpha / (pi * d * d) / view[2];
    };
    constexpr int rows = 16, columns = 16, fine = 64;  // rows evenly in the cumulative of D alone
    const auto z_at = [&](double share) {              // D(h) h.z integrates to this
      return std::sqrt((1 - share) / (1 + share * (alpha * alpha - 1)));
    };
    std::vector<double> probability(rows * columns);
    for (int r = 0; r < rows * fine; ++r)
      for (int c = 0; c < columns * fine; ++c) {
        const double z0 = z_at(static_cast<double>(r) / (rows * fine)), z1 = z_at((r + 1.0) / (rows * fine));
        const double phi = 2 * pi * (c + 0.5) / (columns * fine);
        probability[static_cast<std::size_t>(r / fine * columns + c / fine)] +=
            density(z_at((r + 0.5) / (rows * fine)), phi) * (z0 - z1) * 2 * pi / (columns * fine);
      }
    double whole = 0;
    for (double p : probability) whole += p;
    EXPECT_NEAR(whole, 1, 1e-3) << "the density is normalised";
    const Samples samples = draw(SAMPLE_GGX, static_cast<float>(alpha));
    std::vector<int> seen(rows * columns);
    for (const auto &s : samples) {
      const double z2 = static_cast<double>(s[2]) * static_cast<double>(s[2]);
      const double share = (1 - z2) / (1 + z2 * (alpha * alpha - 1));
      const int row = std::clamp(static_cast<int>(rows * share), 0, rows - 1);
      ++seen[static_cast<std::size_t>(row * columns + std::clamp(static_cast<int>(columns * turn(s)), 0, columns - 1))];
    }
    std::vector<int> pooled_seen{0};  // bins that expect fewer than ten are one
    std::vector<double> pooled{0};
    for (std::size_t b = 0; b < seen.size(); ++b) {
      const bool rare = probability[b] * static_cast<double>(drawn) < 10;
      if (!rare) pooled_seen.push_back(0), pooled.push_back(0);
      const std::size_t at = rare ? 0 : pooled.size() - 1;
      pooled_seen[at] += seen[b], pooled[at] += probability[b] / whole;
    }
    if (pooled[0] * static_cast<double>(drawn) < 10)  // too few even together: join a neighbour
      pooled[1] += pooled[0], pooled_seen[1] += pooled_seen[0], pooled.erase(pooled.begin()),
          pooled_seen.erase(pooled_seen.begin());
    EXPECT_GT(pooled.size(), 100u);
    EXPECT_LT(chi_square(pooled_seen, pooled, drawn), chi_square_limit(pooled.size() - 1)) << alpha;
  }
}

// oracle: the mean of what survives is what the surface keeps
// tolerance: 5 standard deviations of the mean of a Bernoulli variable
TEST_P(Sampling, RouletteKeepsTheMean) {
  for (float kept : {0.02f, 0.5f, 0.9f, 1.0f}) {
    double first = 0, second = 0, largest = 0;
    for (const auto &s : draw(SAMPLE_ROULETTE, kept)) {
      first += static_cast<double>(s[0]), second += static_cast<double>(s[1]);
      largest = std::max(largest, static_cast<double>(s[0]));
    }
    const double share = static_cast<double>(kept), n = static_cast<double>(drawn);
    EXPECT_NEAR(first / n, share, 5 * std::sqrt(share * (1 - share) / n) + 1e-6);
    EXPECT_NEAR(second / n, share / 2, 2.5 * std::sqrt(share * (1 - share) / n) + 1e-6);
    EXPECT_NEAR(largest, 1, 1e-6) << "a survivor carries what it had";
  }
}

// oracle: the host twin, the same text
// tolerance: sine and cosine of the device are good to 4 ulp of 1; GGX divides by lengths of 0.4 and more: 5e-6
TEST(SamplingTwin, DeviceDrawsWhatTheHostDraws) {
  for (auto kind : {SAMPLE_DISC, SAMPLE_COSINE, SAMPLE_CONE, SAMPLE_TRIANGLE, SAMPLE_GGX, SAMPLE_ROULETTE}) {
    const Samples host = host_samples(kind, 0.4f, 20000, 5),
                  device = device_samples(shared_device(), kind, 0.4f, 20000, 5);
    for (std::size_t i = 0; i < host.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(host[i][k], device[i][k], 5e-6) << kind << " " << i;
  }
}

// oracle: words differ where any part of the key does
// tolerance: none
TEST(SamplingTwin, EveryPartOfTheKeyCounts) {
  const RandomWords base = photon_words(1, 2, 3, 4, 5);
  for (const RandomWords &other :
       {photon_words(9, 2, 3, 4, 5), photon_words(1, 9, 3, 4, 5), photon_words(1, 2, 9, 4, 5),
        photon_words(1, 2, 3, 9, 5), photon_words(1, 2, 3, 4, 9)})
    for (int k = 0; k < 4; ++k) EXPECT_NE(base.word[k], other.word[k]);
}

// oracle: Born & Wolf: normal incidence ((n-1)/(n+1))^2 = 0.04 for 1.5; Brewster's angle; total reflection; aluminium
// at
//         normal incidence ((n-1)^2 + k^2)/((n+1)^2 + k^2); grazing 1; a conductor without absorption is a dielectric
// tolerance: roundings of float
TEST(SamplingTwin, Fresnel) {
  float beyond = 0;
  EXPECT_NEAR(fresnel_dielectric(1, 1.5f, &beyond), 0.04f, 1e-7);
  EXPECT_NEAR(beyond, 1, 1e-7);
  const double brewster = std::atan(1.5);
  const double across = std::pow(std::sin(brewster - (pi / 2 - brewster)) / std::sin(pi / 2), 2);
  EXPECT_NEAR(fresnel_dielectric(static_cast<float>(std::cos(brewster)), 1.5f, &beyond), 0.5 * across, 1e-7);
  EXPECT_EQ(fresnel_dielectric(0.1f, 1 / 1.5f, &beyond), 1);
  EXPECT_EQ(beyond, 0);
  EXPECT_NEAR(fresnel_conductor(1, 1.0f, 6.6f), (6.6 * 6.6) / (4 + 6.6 * 6.6), 1e-6);
  EXPECT_NEAR(fresnel_conductor(0, 1.0f, 6.6f), 1, 1e-6);
  for (float cosine : {0.05f, 0.4f, 0.9f})
    EXPECT_NEAR(fresnel_conductor(cosine, 1.5f, 0), fresnel_dielectric(cosine, 1.5f, &beyond), 1e-6);
}

// oracle: Snell's law: n sin is kept; and the refracted direction is unit
// tolerance: roundings of float
TEST(SamplingTwin, RefractionObeysSnell) {
  for (float index : {1.5f, 1 / 1.5f, 1.0003f})
    for (float sine : {0.0f, 0.3f, 0.6f}) {
      const float cosine = std::sqrt(1 - sine * sine);
      float beyond;
      (void)fresnel_dielectric(cosine, index, &beyond);
      const Vec3 d = refracted(vec3(sine, 0, -cosine), vec3(0, 0, 1), cosine, index, beyond);
      EXPECT_NEAR(d.x * index, sine, 1e-6);
      EXPECT_NEAR(length3(d), 1, 1e-6);
      EXPECT_LT(d.z, 0);
    }
}

// oracle: the angle between a direction and what becomes of it, in double; axes exact
// tolerance: half a step 1.5e-5 in u and v moves a point of the octahedron by sqrt(6) of it at most, seen from
// 1/sqrt(3)
//            away: 6.5e-5; 10 bits: half of 1/511
TEST(SamplingTwin, PackedDirectionsComeBack) {
  std::mt19937 engine(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 20000; ++i) {
    double d[3] = {normal(engine), normal(engine), normal(engine)};
    if (i < 6) d[0] = d[1] = d[2] = 0, d[i / 2] = i % 2 ? 1 : -1;
    const double l = std::hypot(d[0], d[1], d[2]);
    float x, y, z;
    const float in[3] = {static_cast<float>(d[0] / l), static_cast<float>(d[1] / l), static_cast<float>(d[2] / l)};
    unpack_direction(pack_direction(in[0], in[1], in[2]), &x, &y, &z);
    const double off =
        std::hypot(static_cast<double>(x - in[0]), static_cast<double>(y - in[1]), static_cast<double>(z - in[2]));
    ASSERT_LT(off, 6.5e-5);
    const unsigned packed = pack_normal(in[0], in[1], in[2]);
    double off_normal = 0;
    for (int k = 0; k < 3; ++k)
      off_normal = std::max(off_normal, static_cast<double>(std::abs(unpack_normal(packed, k) - in[k])));
    ASSERT_LT(off_normal, 0.5 / 511 + 1e-6);
    if (i < 6) {
      EXPECT_EQ(off, 0);
      EXPECT_EQ(off_normal, 0);
    }
  }
}

}  // namespace
}  // namespace greenray
