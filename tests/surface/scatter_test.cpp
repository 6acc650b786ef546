// What rough surfaces make of a path: energy, reciprocity, and densities written down here.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "twin/room_twin.hpp"

namespace greenray {
namespace {

using namespace room_twin;

Vec3 towards(double elevation_deg, double azimuth_deg = 0) {
  const double e = elevation_deg * M_PI / 180, a = azimuth_deg * M_PI / 180;
  return vec3(static_cast<float>(std::cos(e) * std::cos(a)), static_cast<float>(std::cos(e) * std::sin(a)),
              static_cast<float>(std::sin(e)));
}

/// Smith and GGX in double, after Walter et al. 2007 and Heitz 2014.
double density(double cosine, double alpha) {
  const double a2 = alpha * alpha, d = 1 + (a2 - 1) * cosine * cosine;
  return a2 / (M_PI * d * d);
}
double lambda(double cosine, double alpha) {
  const double t2 = (1 - cosine * cosine) / (cosine * cosine);
  return 0.5 * (std::sqrt(1 + alpha * alpha * t2) - 1);
}

struct Sampled {
  double reflected = 0, passed = 0;          // means of the weights
  std::vector<std::array<double, 4>> paths;  // direction out, weight (0: ended)
};

/// A conductor that reflects everything (n = 0, k = 1e4: |r| = 1), or glass without loss.
Sampled sample(int kind, double alpha, const Vec3 &back, int count, double index) {
  Material m{};
  m.kind = kind, m.roughness = static_cast<float>(alpha), m.index = 0, m.extinction = 1;
  m.texture = m.absorption = -1;
  std::vector<float> spectra(16, 0.0f);
  for (std::size_t w = 8; w < 16; ++w) spectra[w] = 1e4f;
  const Looks looks{&m, spectra.data(), nullptr, nullptr, nullptr, nullptr};
  const float white[8] = {1, 1, 1, 1, 1, 1, 1, 1};
  const Vec3 normal = vec3(0, 0, 1);
  Sampled out;
  for (int i = 0; i < count; ++i) {
    const RandomWords words = photon_words(5, 0, static_cast<unsigned>(i), 1, 2);
    Bundle b{};
    for (float &w : b.weight) w = 1;
    b.split = 1;
    Vec3 direction = times(back, -1);
    int passes = 0;
    const int goes_on = kind == MATERIAL_ROUGH_CONDUCTOR
                            ? scatter_reflecting(&looks, &m, white, normal, words, &direction, &b)
                            : scatter_glass(&m, spectra.data(), 1, normal, 1, static_cast<float>(index), words,
                                            &direction, &b, &passes);
    const double weight = goes_on ? static_cast<double>(b.weight[0]) : 0;
    (passes ? out.passed : out.reflected) += weight / count;
    out.paths.push_back(
        {static_cast<double>(direction.x), static_cast<double>(direction.y), static_cast<double>(direction.z), weight});
  }
  return out;
}

// oracle: a white furnace: a surface that absorbs nothing gives back no more than it gets, and what one scattering of
//         facets gives back: E = integral of G2/(4 cos) D over the hemisphere, by quadrature in double
// tolerance: 5 standard errors of a mean of numbers in 0..1: 0.01
TEST(RoughSurface, ConductorKeepsTheEnergyOfOneScattering) {
  for (const double alpha : {0.05, 0.3, 1.0})
    for (const double elevation : {80.0, 45.0, 10.0}) {
      const double cosine = std::sin(elevation * M_PI / 180), sine = std::sqrt(1 - cosine * cosine);
      double expected = 0;
      constexpr int rows = 2000, columns = 400;
      for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
          // facets, evenly in the cumulative of D cos: cos^2 = (1 - u)/(1 + u (a^2 - 1))
          const double u = (r + 0.5) / rows, phi = 2 * M_PI * (c + 0.5) / columns;
          const double hz = std::sqrt((1 - u) / (1 + u * (alpha * alpha - 1))), hs = std::sqrt(1 - hz * hz);
          const double facing = sine * hs * std::cos(phi) + cosine * hz, out = 2 * facing * hz - cosine;
          if (facing <= 0 || out <= 0) continue;
          // D hz dh = du dphi/2pi; E = int D G2 facing/cosine dh
          expected += facing / (cosine * hz) / (1 + lambda(cosine, alpha) + lambda(out, alpha)) / (rows * columns);
        }
      const Sampled s = sample(MATERIAL_ROUGH_CONDUCTOR, alpha, towards(elevation), 60000, 0);
      EXPECT_NEAR(s.reflected, expected, 0.01) << alpha << " " << elevation;
      EXPECT_LE(s.reflected, 1 + 1e-6);
    }
}

// oracle: Walter et al. 2007, eq 20: f(i, o) = D G2 F/(4 cos cos), which is the same both ways; weights over samples
//         near a direction estimate f cos
// tolerance: 6 %, some 2000 samples in each cone
TEST(RoughSurface, ConductorFollowsItsFormulaBothWays) {
  const double alpha = 0.5, cone = std::cos(6 * M_PI / 180);
  for (const auto &[from, to] : {std::pair{60.0, 30.0}, {30.0, 60.0}, {75.0, 45.0}}) {
    const Sampled s = sample(MATERIAL_ROUGH_CONDUCTOR, alpha, towards(from), 400000, 0);
    const Vec3 in = towards(from), aim = towards(to, 150);
    double sum = 0;
    for (const auto &p : s.paths)
      if (p[0] * static_cast<double>(aim.x) + p[1] * static_cast<double>(aim.y) + p[2] * static_cast<double>(aim.z) >
          cone)
        sum += p[3];
    const double measured = sum / 400000 / (2 * M_PI * (1 - cone));
    const Vec3 h = unit3(plus(in, aim));
    const double ci = static_cast<double>(in.z), co = static_cast<double>(aim.z);
    const double f =
        density(static_cast<double>(h.z), alpha) / (1 + lambda(ci, alpha) + lambda(co, alpha)) / (4 * ci * co);
    EXPECT_NEAR(measured / (f * co), 1, 0.06) << from << " to " << to;
  }
}

// oracle: rough glass gives no more than it gets; nearly smooth glass parts light as Fresnel says (written down here)
// tolerance: 0.005, five standard errors of a share of 100000
TEST(RoughSurface, GlassKeepsEnergyAndTendsToFresnel) {
  for (const double alpha : {0.002, 0.1, 0.5})
    for (const double elevation : {85.0, 50.0, 25.0})
      for (const double index : {1.5, 1 / 1.5}) {
        const Sampled s = sample(MATERIAL_ROUGH_DIELECTRIC, alpha, towards(elevation), 100000, index);
        EXPECT_LE(s.reflected + s.passed, 1 + 1e-6);
        if (alpha > 0.01) continue;
        const double in = (90 - elevation) * M_PI / 180, sine = std::sin(in) / index;
        double reflected = 1;
        if (sine < 1) {
          const double out = std::asin(sine);
          reflected = 0.5 * (std::pow(std::sin(in - out) / std::sin(in + out), 2) +
                             std::pow(std::tan(in - out) / std::tan(in + out), 2));
        }
        EXPECT_NEAR(s.reflected, reflected, 0.005) << elevation << " " << index;
        EXPECT_NEAR(s.reflected + s.passed, 1, 0.005);
      }
}

// oracle: whichever wavelength leads, the mean over all leaders of what a split leaves is what was there before
// tolerance: none: WAVES is a power of two
TEST(DispersingGlass, ASplitKeepsEveryWavelength) {
  constexpr int waves = 8;
  float sum[waves] = {};
  for (int hero = 0; hero < waves; ++hero) {
    Bundle b{};
    for (int w = 0; w < waves; ++w) b.weight[w] = static_cast<float>(w + 1);
    b.hero = hero;
    split_bundle(&b);
    split_bundle(&b);  // a second time changes nothing
    for (int w = 0; w < waves; ++w) sum[w] += b.weight[w] / waves;
  }
  for (int w = 0; w < waves; ++w) EXPECT_EQ(sum[w], static_cast<float>(w + 1));
}

/// Born & Wolf, section 1.5.2, in double; 1 beyond the angle of total reflection.
double fresnel(double cosine, double index) {
  const double sine2 = (1 - cosine * cosine) / (index * index);
  if (sine2 >= 1) return 1;
  const double beyond = std::sqrt(1 - sine2);
  const double across = (cosine - index * beyond) / (cosine + index * beyond),
               within = (index * cosine - beyond) / (index * cosine + beyond);
  return 0.5 * (across * across + within * within);
}

// oracle: every wavelength is reflected by its own Fresnel share and the rest goes through, whichever one leads; what
// is
//         reflected stays together, what goes through is one alone. From inside at a cosine of 0.65 some of the
//         wavelengths are reflected totally and others are not
// tolerance: 5 standard errors of weights up to 8: 5 (8/300000)^(1/2) = 0.026
TEST(DispersingGlass, WavelengthsStayTogetherWhereTheyAreReflected) {
  Material m{};
  m.kind = MATERIAL_DIELECTRIC, m.disperses = 1, m.texture = m.absorption = -1;
  std::vector<float> glass;
  for (int w = 0; w < 8; ++w) glass.push_back(1.2f + 0.05f * static_cast<float>(w));
  constexpr int count = 300000;
  for (const auto &[from_outside, cosine] : {std::pair{1, 0.9}, {1, 0.15}, {0, 0.9}, {0, 0.65}}) {
    double reflected[8] = {}, passed[8] = {};
    const Vec3 normal = vec3(0, 0, 1);
    for (int i = 0; i < count; ++i) {
      const RandomWords words = photon_words(6, 0, static_cast<unsigned>(i), 1, 2);
      Bundle b{};
      for (float &w : b.weight) w = 1;
      b.hero = i % 8;
      Vec3 direction = vec3(static_cast<float>(std::sqrt(1 - cosine * cosine)), 0, static_cast<float>(-cosine));
      int passes = 0;
      const float inside = glass[static_cast<std::size_t>(b.hero)];
      ASSERT_TRUE(scatter_glass(&m, glass.data(), from_outside, normal, from_outside ? 1 : inside,
                                from_outside ? inside : 1, words, &direction, &b, &passes));
      EXPECT_EQ(b.split, passes);
      for (std::size_t w = 0; w < 8; ++w) (passes ? passed : reflected)[w] += static_cast<double>(b.weight[w]) / count;
    }
    for (std::size_t w = 0; w < 8; ++w) {
      const double n = static_cast<double>(glass[w]), share = fresnel(cosine, from_outside ? n : 1 / n);
      EXPECT_NEAR(reflected[w], share, 0.026) << from_outside << " " << cosine << " " << w;
      EXPECT_NEAR(passed[w], 1 - share, 0.026) << from_outside << " " << cosine << " " << w;
    }
  }
}

}  // namespace
}  // namespace greenray
