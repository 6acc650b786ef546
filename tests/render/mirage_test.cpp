// Branches, folds, trapped strips and numbers of images against an independent integrator and against Bouguer's
// formula.
#include "render/mirage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>

#include "atmosphere/profile_file.hpp"
#include "support/angle.hpp"
#include "support_code/reference_table.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

using testing_data::ReferenceRow;
using testing_data::ReferenceTable;

const ReferenceTable &table(const std::string &name) {
  static std::map<std::string, std::unique_ptr<ReferenceTable>> known;
  auto &found = known[name];
  if (!found) found = std::make_unique<ReferenceTable>("../mirage/" + name + ".csv");
  return *found;
}

struct Case {
  std::string profile;
  double height_m, wavelength_nm;
  bool is(const ReferenceRow &row) const {
    return row.text("profile") == profile && row.number("height_m") == height_m &&
           row.number("wavelength_nm") == wavelength_nm;
  }
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const ReferenceRow &row : table("strips").rows())
    if (all.empty() || !all.back().is(row))
      all.push_back({row.text("profile"), row.number("height_m"), row.number("wavelength_nm")});
  return all;
}

/// A shipped profile, one made for these tests, or one of the reference tables.
Profile profile_of(const std::string &name) {
  for (const std::string &file :
       {GREENRAY_SOURCE + ("/profiles/" + name), GREENRAY_TEST_DATA + ("/mirage/profiles/" + name),
        GREENRAY_TEST_DATA + ("/reference/profiles/" + name)})
    if (std::filesystem::exists(file + ".toml")) return Profile(load_profile(file + ".toml", "", {}));
  throw std::runtime_error("no profile " + name);
}

Mirages mirages_of(const Profile &air, double height_m, double wavelength_nm) {
  SkyRayOptions options;
  options.height_m = height_m;
  options.precision = Precision::double_;
  options.error_arcsec = 0.001;
  SkyRays rays(air, {wavelength_nm}, options, shared_device());
  return find_mirages(rays, air).front();
}

class MirageOf : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    found_ = mirages_of(profile_of(GetParam().profile), GetParam().height_m, GetParam().wavelength_nm);
  }
  std::vector<const ReferenceRow *> rows(const std::string &name) const {
    std::vector<const ReferenceRow *> some;
    for (const ReferenceRow &row : table(name).rows())
      if (GetParam().is(row)) some.push_back(&row);
    return some;
  }
  Mirages found_;
};

// oracle: tests/oracle/mirages.py: bisection over rays by quadrature of Bouguer's integrals, in double, sharing nothing
// tolerance: 2e-6 deg: both are exact but for what their n(h) differ by near a fold of N; asked for: 0.005 deg
TEST_P(MirageOf, strips_end_where_the_rays_say) {
  const auto wanted = rows("strips");
  std::size_t at = 0;
  while (at < found_.fates.size() && found_.fates[at].high_deg < wanted.front()->number("low_deg")) ++at;
  for (std::size_t i = 0; i < wanted.size(); ++i, ++at) {
    ASSERT_LT(at, found_.fates.size());
    EXPECT_STREQ(outcome_name(found_.fates[at].outcome), wanted[i]->text("status").c_str());
    if (i > 0) {
      EXPECT_NEAR(found_.fates[at].low_deg, wanted[i]->number("low_deg"), 2e-6);
    }
  }
  EXPECT_EQ(at, found_.fates.size()) << "strips above the reference's range";
}

// oracle: the same script: golden section on the true altitude of rays by quadrature
// tolerance: in true altitude 0.01": the table's error, 0.001", times what |dR/da| near a kink makes of it; in apparent
//            altitude 5e-4 deg, for an extreme is flat: sqrt(2 x 0.001" / curvature) at the flattest of them; asked
//            for: 0.005
TEST_P(MirageOf, folds_are_where_the_true_altitude_turns) {
  const auto wanted = rows("folds");
  ASSERT_EQ(found_.folds.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const Fold &fold = found_.folds[i];
    EXPECT_EQ(fold.number, static_cast<int>(i) + 1);
    EXPECT_EQ(fold.highest, wanted[i]->text("kind") == "maximum");
    EXPECT_NEAR(fold.apparent_altitude_deg, wanted[i]->number("apparent_altitude_deg"), 5e-4);
    EXPECT_NEAR(fold.true_altitude_deg, wanted[i]->number("true_altitude_deg"), 0.01 / 3600);
  }
}

// oracle: the same script: changes of sign along its samples.  tolerance: none
TEST_P(MirageOf, images_are_counted_exactly) {
  for (const ReferenceRow *row : rows("counts"))
    EXPECT_EQ(found_.images_of(row->number("true_altitude_deg")), row->number("images"))
        << row->text("true_altitude_deg");
}

// oracle: what a branch is: monotone between its ends, the next one beginning where it ends at a fold, upside down in
// turn tolerance: none
TEST_P(MirageOf, branches_are_in_order) {
  ASSERT_FALSE(found_.branches.empty());
  std::size_t folds = 0;
  for (std::size_t i = 0; i < found_.branches.size(); ++i) {
    const Branch &b = found_.branches[i];
    EXPECT_EQ(b.number, static_cast<int>(i) + 1);
    EXPECT_LT(b.low_deg, b.high_deg);
    EXPECT_EQ(b.erect, b.true_at_high_deg > b.true_at_low_deg);
    if (b.high_end != BranchEnd::fold) continue;
    ++folds;
    ASSERT_LT(i + 1, found_.branches.size());
    EXPECT_EQ(found_.branches[i + 1].low_end, BranchEnd::fold);
    EXPECT_EQ(found_.branches[i + 1].low_deg, b.high_deg);
    EXPECT_NE(found_.branches[i + 1].erect, b.erect);
  }
  EXPECT_EQ(folds, found_.folds.size());
  EXPECT_EQ(found_.branches.back().high_end, BranchEnd::zenith);
  EXPECT_EQ(found_.images_of(45), 1);
}

std::string name_of(const ::testing::TestParamInfo<Case> &test) {
  std::string name = test.param.profile + "_" + std::to_string(static_cast<int>(test.param.height_m)) + "m_" +
                     std::to_string(static_cast<int>(test.param.wavelength_nm)) + "nm";
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, MirageOf, ::testing::ValuesIn(cases()), name_of);

/// A medium of straight lines in n - 1 between heights.
Profile medium(const std::vector<std::pair<double, double>> &rows) {
  ProfileSpec spec;
  for (const auto &[height_m, refractivity] : rows) spec.index_levels.push_back({height_m, refractivity, {}});
  return Profile(spec);
}

// oracle: Bouguer: a ray is level where N(h) = N(eye) cos e, N = n (1 + h/R): held between -e and e with cos e =
//         N(top)/N(eye); the ground is met below cos e = N(0)/N(eye).  Closed form in exact numbers.
// tolerance: 1e-8 deg: breaks are bracketed to 1e-10 rad
TEST(Mirages, a_duct_holds_what_bouguer_says) {
  const Profile air = medium({{0, 281e-6}, {40, 280e-6}, {60, 272e-6}, {200, 268e-6}});
  const double radius = air.spec().earth_radius_m;
  const auto big_n = [&](double h, double refractivity) { return std::log1p(refractivity) + std::log1p(h / radius); };
  const double eye = big_n(50, 276e-6), top = big_n(60, 272e-6), ground = big_n(0, 281e-6);
  const double held_deg = to_deg(std::acos(std::exp(top - eye))),
               ground_deg = -to_deg(std::acos(std::exp(ground - eye)));
  const Mirages m = mirages_of(air, 50, 550);
  ASSERT_EQ(m.fates.size(), 4U) << "ground, sky below the duct, held, sky";
  EXPECT_NEAR(m.fates[0].high_deg, ground_deg, 1e-8);
  EXPECT_EQ(m.fates[2].outcome, f64::RAY_TRAPPED);
  EXPECT_NEAR(m.fates[2].low_deg, -held_deg, 1e-8);
  EXPECT_NEAR(m.fates[2].high_deg, held_deg, 1e-8);
  EXPECT_EQ(m.branches.front().low_end, BranchEnd::horizon);
  EXPECT_EQ(m.branches.back().low_end, BranchEnd::duct_edge);
  EXPECT_TRUE(std::isfinite(m.branches.back().true_at_low_deg))
      << "the top is a corner: rays cross it in finite distance";
}

// oracle: Bouguer: at a smooth minimum of N (Fermi step) a level ray goes round for ever: the true altitude falls below
// all
//         bounds, and every low altitude is seen.  tolerance: none
TEST(Mirages, beside_a_smooth_duct_the_sky_is_seen_however_low) {
  ProfileSpec spec;
  spec.inversions.push_back({});
  spec.inversions.back().delta_T_K = 8.0, spec.inversions.back().height_m = 50.0;
  spec.inversions.back().diffuseness_m = 5.0;
  const Mirages m = mirages_of(Profile(spec), 45, 550);
  EXPECT_EQ(m.branches.back().low_end, BranchEnd::duct_edge);
  EXPECT_TRUE(std::isinf(m.branches.back().true_at_low_deg));
  EXPECT_GE(m.images_of(-50), 1);
}

// oracle: in n = n0 (R/r)^k the true altitude of no ray turns: de/da = 1/(1 - k) > 0 everywhere.  tolerance: none
TEST(Mirages, constant_curvature_folds_nothing) {
  const double radius = ProfileSpec{}.earth_radius_m;
  for (const double k : {-2.0, 0.0, 0.17, 0.8}) {
    const double slope = k * (1 + 280e-6) / radius;
    const Mirages m = mirages_of(medium({{0, 280e-6}, {120, 280e-6 - 120 * slope}}), 30, 550);
    EXPECT_LE(m.folds.size(), k < 0 || k > 0 ? 1U : 0U) << k << ": at most where the medium ends";
    EXPECT_EQ(m.branches.back().erect, true);
  }
}

}  // namespace
}  // namespace greenray
