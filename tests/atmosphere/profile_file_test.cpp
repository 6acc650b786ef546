// Profile files: defaults, every key, round trips, and what is said about wrong ones.
#include "atmosphere/profile_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace greenray {
namespace {

void expect_same(const AlongSurface &a, const AlongSurface &b) {
  EXPECT_EQ(a.x_m, b.x_m);
  EXPECT_EQ(a.value, b.value);
}

void expect_same_rows(const ProfileSpec &a, const ProfileSpec &b) {
  ASSERT_EQ(a.levels.size(), b.levels.size());
  for (std::size_t i = 0; i < a.levels.size(); ++i) {
    EXPECT_EQ(a.levels[i].height_m, b.levels[i].height_m);
    EXPECT_EQ(a.levels[i].temperature_K, b.levels[i].temperature_K);
    EXPECT_EQ(a.levels[i].pressure_Pa, b.levels[i].pressure_Pa);
    EXPECT_EQ(a.levels[i].relative_humidity, b.levels[i].relative_humidity);
  }
  ASSERT_EQ(a.inversions.size(), b.inversions.size());
  for (std::size_t i = 0; i < a.inversions.size(); ++i) {
    expect_same(a.inversions[i].delta_T_K, b.inversions[i].delta_T_K);
    expect_same(a.inversions[i].height_m, b.inversions[i].height_m);
    expect_same(a.inversions[i].diffuseness_m, b.inversions[i].diffuseness_m);
  }
  ASSERT_EQ(a.surface_layers.size(), b.surface_layers.size());
  for (std::size_t i = 0; i < a.surface_layers.size(); ++i) {
    EXPECT_EQ(a.surface_layers[i].delta_T_K, b.surface_layers[i].delta_T_K);
    EXPECT_EQ(a.surface_layers[i].scale_m, b.surface_layers[i].scale_m);
  }
  ASSERT_EQ(a.index_levels.size(), b.index_levels.size());
  for (std::size_t i = 0; i < a.index_levels.size(); ++i) {
    EXPECT_EQ(a.index_levels[i].height_m, b.index_levels[i].height_m);
    EXPECT_EQ(a.index_levels[i].refractivity, b.index_levels[i].refractivity);
  }
}

/// Places, names and notes belong to the file, not to the air.
void expect_same_air(const ProfileSpec &a, const ProfileSpec &b) {
  EXPECT_EQ(a.base_is_us76, b.base_is_us76);
  EXPECT_EQ(a.index, b.index);
  EXPECT_EQ(a.earth_radius_m, b.earth_radius_m);
  EXPECT_EQ(a.surface_pressure_Pa, b.surface_pressure_Pa);
  EXPECT_EQ(a.interpolation, b.interpolation);
  EXPECT_EQ(a.smooth_m, b.smooth_m);
  EXPECT_EQ(a.exaggerate, b.exaggerate);
  expect_same_rows(a, b);
}

std::vector<Diagnostic> complaints(const std::string &text) {
  try {
    parse_profile("air.toml", text);
  } catch (const InputError &error) {
    return error.diagnostics();
  }
  return {};
}

// oracle: the default values listed in the profile section of the file format
// tolerance: none, the numbers are read, not computed
TEST(ProfileFile, EmptyFileIsTheStandardAtmosphere) {
  const ProfileSpec spec = parse_profile("folder/calm.toml", "");
  EXPECT_EQ(spec.name, "calm");
  EXPECT_TRUE(spec.base_is_us76);
  EXPECT_EQ(spec.index, IndexModel::born_wolf);
  EXPECT_EQ(spec.earth_radius_m, 6371000.0);
  EXPECT_EQ(spec.surface_pressure_Pa, 101325.0);
  EXPECT_EQ(spec.interpolation, Interpolation::linear);
  EXPECT_EQ(spec.smooth_m, 0.0);
  EXPECT_EQ(spec.exaggerate, 1.0);
  EXPECT_TRUE(spec.levels.empty() && spec.inversions.empty());
  EXPECT_TRUE(spec.surface_layers.empty() && spec.index_levels.empty());
}

const char *const every_key = R"(base = "none"
index = "peck-reeder"
earth_radius_m = 6.4e6
surface_pressure_Pa = 100000
interpolation = "cubic"
smooth_m = 1.5
exaggerate = 2
[[level]]
height_m = 0
temperature_K = 290
pressure_Pa = 101000
relative_humidity = 0.8
[[level]]
height_m = 120000
temperature_K = 180.5
[[inversion]]
delta_T_K = 8.0
height_m = { x_m = [0.0, 2e4], value = [50, 30] }
diffuseness_m = 5.0
[[surface_layer]]
delta_T_K = -2.0
scale_m = 0.5
)";

// oracle: the numbers written in the text above; places counted by hand
// tolerance: none
TEST(ProfileFile, ReadsEveryKey) {
  const ProfileSpec spec = parse_profile("air.toml", every_key);
  EXPECT_FALSE(spec.base_is_us76);
  EXPECT_EQ(spec.index, IndexModel::peck_reeder);
  EXPECT_EQ(spec.earth_radius_m, 6.4e6);
  EXPECT_EQ(spec.surface_pressure_Pa, 1e5);
  EXPECT_EQ(spec.interpolation, Interpolation::cubic);
  EXPECT_EQ(spec.smooth_m, 1.5);
  EXPECT_EQ(spec.exaggerate, 2.0);
  ASSERT_EQ(spec.levels.size(), 2u);
  EXPECT_EQ(spec.levels[0].pressure_Pa, 101000.0);
  EXPECT_EQ(spec.levels[0].relative_humidity, 0.8);
  EXPECT_EQ(spec.levels[1].height_m, 120000.0);
  EXPECT_EQ(spec.levels[1].temperature_K, 180.5);
  EXPECT_FALSE(spec.levels[1].pressure_Pa);
  EXPECT_EQ(spec.levels[1].place.line, 13);
  ASSERT_EQ(spec.inversions.size(), 1u);
  EXPECT_EQ(spec.inversions[0].delta_T_K.constant(), 8.0);
  EXPECT_EQ(spec.inversions[0].height_m.x_m, (std::vector<double>{0, 2e4}));
  EXPECT_EQ(spec.inversions[0].height_m.value, (std::vector<double>{50, 30}));
  ASSERT_EQ(spec.surface_layers.size(), 1u);
  EXPECT_EQ(spec.surface_layers[0].delta_T_K, -2.0);
  EXPECT_EQ(spec.surface_layers[0].scale_m, 0.5);
}

// oracle: the gradient of dT/(1 + exp(-(h - c)/d)) at c is dT/(4 d), set equal to rise/(to - from)
// tolerance: none, powers of two
TEST(ProfileFile, RampBecomesTheInversionWithItsCentreRiseAndGradient) {
  const ProfileSpec spec = parse_profile("air.toml", "[[inversion]]\nfrom_m = 30\nto_m = 50\nrise_K = 0.8\n");
  ASSERT_EQ(spec.inversions.size(), 1u);
  EXPECT_EQ(spec.inversions[0].delta_T_K.constant(), 0.8);
  EXPECT_EQ(spec.inversions[0].height_m.constant(), 40.0);
  EXPECT_EQ(spec.inversions[0].diffuseness_m.constant(), 5.0);
}

struct Wrong {
  const char *text;
  int line, column;
  const char *says;
};

const std::vector<Wrong> wrong_profiles{
    {"base = \"us67\"", 1, 8, "did you mean 'us76'?"},
    {"base = 76", 1, 8, "expected one of us76"},
    {"base = \"none\"", 1, 8, "expects [[level]] rows"},
    {"index = \"cidor\"", 1, 9, "did you mean 'ciddor'?"},
    {"\nearth_radius_m = 10.0", 2, 18, "from 1000 to 1e+09 m, found 10"},
    {"earth_radius_m = \"6371 km\"", 1, 18, "found text \"6371 km\""},
    {"earth_radius_m = nan", 1, 18, "found nan"},
    {"surface_pressure_Pa = inf", 1, 23, "found inf"},
    {"surface_pressure_Pa = -1", 1, 23, "above 0 and at most 1e+07 Pa, found -1"},
    {"interpolation = \"spline\"", 1, 17, "expected one of linear, cubic"},
    {"smooth_m = -0.5", 1, 12, "a number from 0 to"},
    {"exaggerate = 0", 1, 14, "above 0"},
    {"exaggerate = true", 1, 14, "found true"},
    {"smoth_m = 1", 1, 1, "unknown key 'smoth_m' (did you mean 'smooth_m'?)"},
    {"colour = 1", 1, 1, "expected one of along_surface, azimuth_deg, base, earth_radius_m"},
    {"[level]\nheight_m = 0", 1, 1, "[[level]]"},
    {"level = 3", 1, 9, "[[level]]"},
    {"level = [3]", 1, 10, "[[level]]"},
    {"[[level]]\ntemperature_K = 288", 1, 1, "missing key 'level.height_m'"},
    {"[[level]]\nheight_m = 0", 1, 1, "missing key 'level.temperature_K'"},
    {"[[level]]\nheight_m = -1\ntemperature_K = 288", 2, 12, "from 0 to 120000 m, found -1"},
    {"[[level]]\nheight_m = 0\ntemperature_K = 15", 3, 17, "from 100 to 2000 K"},
    {"[[level]]\nheight_m = 0\ntemperature_K = 288\npressure_Pa = 0", 4, 15, "above 0"},
    {"[[level]]\nheight_m = 0\ntemperature_K = 288\nrelative_humidity = 80", 4, 21, "from 0 to 1"},
    {"[[level]]\nheight_m = 5\ntemperature_K = 288\n[[level]]\nheight_m = 5\ntemperature_K = 287", 5, 12,
     "ascend from row to row by 0.0005 m or more, found 5.0 m after 5.0 m"},
    {"[[level]]\nheight_m = 5\ntemperature_K = 288\npressure_pa = 9e4", 4, 1, "(did you mean 'pressure_Pa'?)"},
    {"[[inversion]]\ndelta_T_K = 8\nheight_m = 50", 1, 1, "missing key 'inversion.diffuseness_m'"},
    {"[[inversion]]\ndelta_T_K = 8\nheight_m = 50\ndiffuseness_m = 0", 4, 17, "from 0.001 to"},
    {"[[inversion]]\ndelta_T_K = 8\nheight_m = 50\ndiffuseness_m = 1e-4", 4, 17, "from 0.001 to"},
    {"[[inversion]]\ndelta_T_K = 8\nheight_m = -50\ndiffuseness_m = 5", 3, 12, "from 0 to 120000 m"},
    {"[[inversion]]\ndelta_T_K = { x_m = [0], value = [1] }\nheight_m = 5\ndiffuseness_m = 5", 2, 21, "at least 2"},
    {"[[inversion]]\ndelta_T_K = { x_m = [0, 0], value = [1, 2] }\nheight_m = 5\ndiffuseness_m = 5", 2, 21, "ascend"},
    {"[[inversion]]\ndelta_T_K = { x_m = [0, 9], value = [1] }\nheight_m = 5\ndiffuseness_m = 5", 2, 37, "as many"},
    {"[[inversion]]\ndelta_T_K = { x_m = [0, 9] }\nheight_m = 5\ndiffuseness_m = 5", 2, 13, "missing key"},
    {"[[inversion]]\ndelta_T_K = { x_m = [0, 9], value = [1, nan] }\nheight_m = 5\ndiffuseness_m = 5", 2, 41, "nan"},
    {"[[inversion]]\nfrom_m = 50\nto_m = 30\nrise_K = 1", 3, 8, "0.004 m or more above from_m"},
    {"[[inversion]]\nfrom_m = 5\ndelta_T_K = 3", 2, 10, "not some of each"},
    {"[[surface_layer]]\ndelta_T_K = 5", 1, 1, "missing key 'surface_layer.scale_m'"},
    {"[[surface_layer]]\ndelta_T_K = 5\nscale_m = -1", 3, 11, "from 0.001 to"},
    {"[[index_level]]\nheight_m = 0\nrefractivity = -1", 3, 16, "from -0.9 to 10"},
    {"[[index_level]]\nheight_m = 0\nrefractivity = 0.1\n[[surface_layer]]\ndelta_T_K = 5\nscale_m = 1", 4, 1,
     "not allowed beside [[index_level]]"},
    {"smooth_m = ", 1, 12, "not valid TOML"},
    {"smooth_m = 1\nsmooth_m = 2", 2, 12, "not valid TOML"},
    {"[[level]\n", 1, 9, "not valid TOML"},
    {"smooth_m = é", 1, 12, "expected only inside quotes"},
    {"# é \"\nbase = \"é\" # 'é\n\"\" = 'é\"é'\nä = 1", 4, 1, "expected only inside quotes"},
    {"index = \"\"\"é\"\"é\\\"\"\"é\"\"\"\"\" # é\nö", 2, 1, "expected only inside quotes"},
    {"index = '''\né\\'''\nü = 1", 3, 1, "expected only inside quotes"},
    {"index = \"open\n# é\n", 1, 14, "not valid TOML"},
    {"a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r = 1", 1, 34, "at most 16 parts"},
    {"[.level]\n", 1, 2, "not valid TOML"},
    {"# bad byte \xff", 1, 12, "not valid UTF-8"},
    {"# caf\xc3\xa9\n# \xc3", 2, 3, "not valid UTF-8"},
    {"# \xed\xa0\x80", 1, 3, "not valid UTF-8"},
    {"# caf\xc3\xa9 \xc0\xaf", 1, 8, "not valid UTF-8"},
};

// oracle: line and column counted by hand in each text; ranges and words of the file format
// tolerance: none
TEST(ProfileFile, SaysWhereAndWhatWasExpected) {
  for (const Wrong &wrong : wrong_profiles) {
    SCOPED_TRACE(wrong.text);
    const std::vector<Diagnostic> all = complaints(wrong.text);
    EXPECT_EQ(all.size(), 1u) << (all.empty() ? "" : InputError(all).what());
    if (all.empty()) continue;
    EXPECT_EQ(all[0].place.file, "air.toml");
    EXPECT_EQ(all[0].place.line, wrong.line) << all[0].text();
    EXPECT_EQ(all[0].place.column, wrong.column) << all[0].text();
    EXPECT_NE(all[0].message.find(wrong.says), std::string::npos) << all[0].text();
  }
}

// oracle: three mistakes made, three reported, from top to bottom
// tolerance: none
TEST(ProfileFile, ReportsAllMistakesAtOnce) {
  const auto all = complaints("bse = 1\nsmooth_m = -1\n[[level]]\nheight_m = 0\ntemperature_K = \"warm\"\n");
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].place.line, 1);
  EXPECT_EQ(all[1].place.line, 2);
  EXPECT_EQ(all[2].place.line, 5);
}

// oracle: the size limit of 16 MiB
// tolerance: none
TEST(ProfileFile, RefusesHugeText) {
  const auto all = complaints(std::string((16u << 20) + 1, '#'));
  ASSERT_EQ(all.size(), 1u);
  EXPECT_NE(all[0].message.find("at most 16 MiB"), std::string::npos);
}

/// A valid profile of awkward numbers: log-uniform, so mantissas of every size.
ProfileSpec random_profile(std::mt19937_64 &random, int round) {
  const auto draw = [&random](double low, double high) {
    return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
  };
  ProfileSpec spec;
  spec.base_is_us76 = round % 2 != 0;
  spec.index = static_cast<IndexModel>(round % 4);
  spec.interpolation = static_cast<Interpolation>(round % 2);
  spec.earth_radius_m = draw(1e3, 1e9);
  spec.surface_pressure_Pa = draw(1e-300, 1e7);
  spec.smooth_m = draw(1e-9, 1e4);
  spec.exaggerate = draw(1e-6, 1e6);
  spec.notes = {"two\nlines, a bell \a and a broken byte \xff"};
  if (round % 3 == 0) {
    spec.index_levels = {{draw(1e-9, 1), draw(1e-9, 1), {}}, {draw(2, 1e7), -draw(1e-9, 0.5), {}}};
    return spec;
  }
  spec.levels = {{draw(1, 900), draw(100, 2000), draw(1, 1e6), {}, {}},
                 {draw(1000, 2000), draw(100, 2000), {}, draw(1e-9, 1), {}}};
  AlongSurface varying;
  varying.x_m = {-draw(1, 1e8), draw(1, 1e8)};
  varying.value = {draw(1, 1e5), draw(1, 1e5)};
  spec.inversions = {{draw(1, 100), varying, draw(1e-3, 1e4), {}}, {-draw(1, 100), draw(1, 1e5), varying, {}}};
  spec.surface_layers = {{-draw(1e-9, 1000), draw(1e-3, 1e5), {}}};
  return spec;
}

// oracle: identity, over profiles drawn at random from a fixed seed
// tolerance: none, the text must hold every bit
TEST(ProfileFile, WriteThenReadIsTheSameAir) {
  std::mt19937_64 random(76);
  for (int round = 0; round < 200; ++round) {
    const ProfileSpec spec = random_profile(random, round);
    const std::string text = write_profile(spec);
    SCOPED_TRACE(text);
    expect_same_air(parse_profile("air.toml", text), spec);
  }
  const ProfileSpec spec = parse_profile("air.toml", every_key);
  expect_same_air(parse_profile("air.toml", write_profile(spec)), spec);
}

// oracle: the shipped us76 is all defaults; the shipped files parse; aliases name the same air
// tolerance: none
TEST(ProfileFile, ShippedProfiles) {
  const std::vector<std::string> names = shipped_profiles();
  for (const char *name : {"us76", "mock-mirage", "hot-road", "double-sun", "cold-sea"})
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
  for (const std::string &name : names) EXPECT_NO_THROW(load_profile(name, "", {})) << name;
  for (const char *name : {"us76", "ussa1976", "us_standard_1976", "us76.toml", "profiles/us76.toml"}) {
    const ProfileSpec spec = load_profile(name, "", {});
    EXPECT_EQ(spec.name, "us76");
    expect_same_air(spec, ProfileSpec{});
  }
  EXPECT_EQ(load_profile("profiles/mock-mirage.toml", "", {}).smooth_m, 2.0);
}

// oracle: the place handed in, and the nearest shipped name
// tolerance: none
TEST(ProfileFile, UnknownProfileIsToldWhereItWasAskedFor) {
  try {
    load_profile("hot-raod", "", {"scene.toml", 7, 11});
    FAIL();
  } catch (const InputError &error) {
    ASSERT_EQ(error.diagnostics().size(), 1u);
    EXPECT_EQ(error.diagnostics()[0].place.line, 7);
    EXPECT_EQ(error.diagnostics()[0].place.column, 11);
    const std::string text = error.what();
    EXPECT_NE(text.find("did you mean 'hot-road'?"), std::string::npos) << text;
    EXPECT_NE(text.find("us76"), std::string::npos) << text;
  }
  EXPECT_THROW(load_profile("", "", {}), InputError);
  EXPECT_THROW(load_profile("/", "", {}), InputError);
}

}  // namespace
}  // namespace greenray
