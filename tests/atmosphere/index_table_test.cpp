// The table the device reads: knots found without hints, its own bound kept, ln n in one piece, nothing thin
// overlooked.
#include "atmosphere/index_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "support/angle.hpp"
#include "support_code/reference_table.hpp"
#include "twin/twin.hpp"

namespace greenray {
namespace {

using testing_data::reference_profile;

constexpr const char *all_profiles[] = {"us76",           "thin_fermi",     "duct_10K",      "hot_road_thin",
                                        "hot_road_thick", "two_inversions", "linear_levels", "cubic_levels",
                                        "ciddor_humid",   "warm_sea"};

double gradient_of(const IndexTable &table, std::size_t row, double z_m) {
  const IndexCellData &c = table.cell(row, table.find(z_m));
  const double t = (z_m - c.bottom_m) / c.thickness_m;
  return c.gradient[0] + t * (c.gradient[1] + t * (c.gradient[2] + t * c.gradient[3]));
}

/// d(ln n)/dz from the profile.
double exact_gradient(const Profile &profile, double h, double nm, double curvature_per_m) {
  const Dual n = profile.refractivity(h, nm);
  return n.slope / (1 + n.value) * (1 + h * curvature_per_m);
}

TEST(IndexTable, KeepsItsBoundAtRandomHeights) {
  // oracle: Profile at 20000 random heights, as many low as high (log-uniform): the gradient's residual, held for the
  // longest
  //         path a grazing ray has in that cell
  // tolerance: 1.3 times the bound: the builder looks at ten heights per cell, this test at any
  std::mt19937 engine(11);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const char *name : all_profiles) {
    const Profile &profile = reference_profile(name);
    for (double wanted : {1e-2, 1e-4}) {
      const IndexTable table = build_index_table(profile, {400, 700}, {false, wanted, 0});
      EXPECT_LE(table.bound_arcsec, wanted) << name;
      double worst = 0;
      for (int i = 0; i < 10000; ++i) {
        const double h = i % 2 ? 119999 * unit(engine) : std::pow(10, -3 + 8 * unit(engine));
        const double z = f64::flattened_height_m(h, table.curvature_per_m);
        const IndexCellData &c = table.cell(0, table.find(z));
        const double path = std::max(c.thickness_m, std::sqrt(8 * c.thickness_m / table.curvature_per_m));
        for (std::size_t row = 0; row < 2; ++row) {
          const double exact = exact_gradient(profile, h, table.wavelength_nm[row], table.curvature_per_m);
          worst = std::max(worst, to_arcsec(path * std::abs(gradient_of(table, row, z) - exact)));
        }
      }
      EXPECT_LT(worst, 1.3 * wanted) << name;
    }
  }
}

TEST(IndexTable, LogIndexIsThatOfTheProfileAndContinuous) {
  // oracle: ln(1 + refractivity) of the profile at random heights; both sides of each knot
  // tolerance: 3e-12 (4 Gauss points per cell carry the integral far beyond the cubic; measured 1.3e-12); at knots
  // rounding
  std::mt19937 engine(12);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const char *name : all_profiles) {
    const Profile &profile = reference_profile(name);
    const IndexTable table = build_index_table(profile, {550}, {false, 1e-3, 0});
    double worst = 0;
    for (int i = 0; i < 5000; ++i) {
      const double h = i % 2 ? 119999 * unit(engine) : std::pow(10, -3 + 8 * unit(engine));
      const double z = f64::flattened_height_m(h, table.curvature_per_m);
      worst = std::max(worst, std::abs(table.log_index(0, z) - std::log1p(profile.refractivity(h, 550).value)));
    }
    EXPECT_LT(worst, 3e-12) << name;
    for (std::size_t i = 0; i + 1 < table.cells_per_row; ++i) {
      const IndexCellData &c = table.cell(0, i), &next = table.cell(0, i + 1);
      const double integral = c.gradient[0] + c.gradient[1] / 2 + c.gradient[2] / 3 + c.gradient[3] / 4;
      EXPECT_NEAR(c.log_index + c.thickness_m * integral, next.log_index, 1e-18 + 3e-16 * next.log_index)
          << name << " " << i;
      EXPECT_NEAR(c.bottom_m + c.thickness_m, next.bottom_m, 3e-16 * next.bottom_m) << name << " " << i;
    }
  }
}

TEST(IndexTable, DensityIsThatOfTheProfile) {
  // oracle: Profile::density_kg_m3 at random heights, all ten profiles
  // tolerance: 1e-5 of the density at sea level: cells are placed for the index, the density follows (measured 3e-6)
  std::mt19937 engine(13);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const char *name : all_profiles) {
    const Profile &profile = reference_profile(name);
    const IndexTable table = build_index_table(profile, {550}, {false, 1e-3, 0});
    double worst = 0;
    for (int i = 0; i < 5000; ++i) {
      const double h = i % 2 ? 119999 * unit(engine) : std::pow(10, -3 + 8 * unit(engine));
      const double z = f64::flattened_height_m(h, table.curvature_per_m);
      const IndexCellData &c = table.cell(0, table.find(z));
      const double t = (z - c.bottom_m) / c.thickness_m;
      const double density = c.density[0] + t * (c.density[1] + t * (c.density[2] + t * c.density[3]));
      worst = std::max(worst, std::abs(density - profile.density_kg_m3(h)) / 1.225);
    }
    EXPECT_LT(worst, 1e-5) << name;
  }
}

TEST(IndexTable, FindsThinLayersAtAnyHeight) {
  // oracle: the profile: an inversion of 1 K over some 0.4 m and 0.1 m (four times its diffuseness) at heights where
  //         no knot is placed by hand: the gradient all through it, and the jump of ln n across it
  // tolerance: gradient 1e-3 of its peak; jump 1e-13 in ln n
  for (double diffuseness_m : {0.1, 0.025})
    for (double height_m : {0.37, 3.21, 37.7, 123.4, 1234.5, 3000.1, 9876.5}) {
      ProfileSpec spec;
      spec.inversions.push_back({1.0, height_m, diffuseness_m, {}});
      const Profile profile(spec);
      const IndexTable table = build_index_table(profile, {550}, {});
      EXPECT_LT(table.cells_per_row, 1000u);
      EXPECT_LE(table.bound_arcsec, 0.003) << height_m << " m, " << diffuseness_m << " m";
      double worst = 0, peak = 0;
      for (int i = -100; i <= 100; ++i) {
        const double h = height_m + 0.1 * i * diffuseness_m;
        if (h < 0) continue;
        const double exact = exact_gradient(profile, h, 550, table.curvature_per_m);
        const double z = f64::flattened_height_m(h, table.curvature_per_m);
        worst = std::max(worst, std::abs(gradient_of(table, 0, z) - exact));
        peak = std::max(peak, std::abs(exact));
      }
      EXPECT_LT(worst, 1e-3 * peak) << height_m << " m, " << diffuseness_m << " m";
      const auto ln_n = [&](double h) { return table.log_index(0, f64::flattened_height_m(h, table.curvature_per_m)); };
      const auto exact = [&](double h) { return std::log1p(profile.refractivity(h, 550).value); };
      const double above = height_m + 20 * diffuseness_m, below = std::max(0.0, height_m - 20 * diffuseness_m);
      EXPECT_NEAR(ln_n(above) - ln_n(below), exact(above) - exact(below), 1e-13) << height_m;
    }
}

TEST(IndexTable, OwnsUpWhenALayerIsTooThinForIt) {
  // oracle: cells are never thinner than a ten-millionth of their height: a layer of half a millimetre at 9.9 km
  //         cannot be had; the bound says so
  // tolerance: the bound is at least the residual seen at 200 heights, within 1.3
  ProfileSpec spec;
  spec.inversions.push_back({1.0, 9876.5, 0.00025, {}});
  const Profile profile(spec);
  const IndexTable table = build_index_table(profile, {550}, {});
  double worst = 0;
  for (int i = -100; i <= 100; ++i) {
    const double h = 9876.5 + 0.000025 * i, z = f64::flattened_height_m(h, table.curvature_per_m);
    const IndexCellData &c = table.cell(0, table.find(z));
    const double path = std::max(c.thickness_m, std::sqrt(8 * c.thickness_m / table.curvature_per_m));
    const double residual = gradient_of(table, 0, z) - exact_gradient(profile, h, 550, table.curvature_per_m);
    worst = std::max(worst, to_arcsec(path * std::abs(residual)));
  }
  EXPECT_GT(worst, 0.003);
  EXPECT_LT(worst, 1.3 * table.bound_arcsec);
}

TEST(IndexTable, FindsAThinLayerThatNoHintPointsAt) {
  // oracle: a bump of n by formula, without kinks_m or features_m: the placing halves down to a fifteenth of the top at
  //         least, so whatever is wider than its ten probes' spacing there is seen; here 5 m wide under a top of 1000 m
  // tolerance: 1e-3 of the steepest gradient
  LayeredMedium medium;
  const auto bump = [](double h) {
    const double u = (h - 437.3) / 5, e = 1e-5 * std::exp(-u * u);
    return Dual(3e-4 + e, -2 * u / 5 * e);
  };
  medium.refractivity = [bump](double h, double) { return bump(h); };
  medium.density_kg_m3 = [](double) { return 0.0; };
  medium.top_m = 1000;
  const IndexTable table = build_index_table(medium, {550}, {});
  for (double h = 400; h < 480; h += 0.37)
    EXPECT_NEAR(gradient_of(table, 0, h), bump(h).slope / (1 + bump(h).value), 2e-9) << h;
}

TEST(IndexTable, KinksAreCellEdges) {
  // oracle: the profile's own list: US76 layers and sounding rows
  // tolerance: 1e-12 relative (flattened and back)
  for (const char *name : {"us76", "linear_levels", "cubic_levels", "late_levels", "ciddor_humid", "laboratory"}) {
    const Profile &profile = reference_profile(name);
    const IndexTable table = build_index_table(profile, {550}, {name == std::string("laboratory"), 1e-3, 0});
    int found = 0, inside = 0;
    for (double kink : profile.kinks_m()) {
      const double z = f64::flattened_height_m(kink, table.curvature_per_m);
      if (z >= table.top_m()) continue;
      ++inside;
      for (std::size_t i = 0; i < table.cells_per_row; ++i)
        found += std::abs(table.cell(0, i).bottom_m - z) <= 1e-12 * z;
    }
    EXPECT_EQ(found, inside) << name;
    EXPECT_GT(inside, 0) << name;
  }
}

TEST(IndexTable, GradientJumpsAtAKinkAndNowhereElse) {
  // oracle: the profile on both sides of 10 m, where the lapse changes from -0.04 to +0.033 K/m
  // tolerance: 1e-6 of the jump
  const Profile &profile = reference_profile("linear_levels");
  const IndexTable table = build_index_table(profile, {550}, {false, 1e-4, 0});
  const double z = f64::flattened_height_m(10, table.curvature_per_m);
  const double below = exact_gradient(profile, 10 - 1e-7, 550, table.curvature_per_m),
               above = exact_gradient(profile, 10 + 1e-7, 550, table.curvature_per_m);
  ASSERT_GT(std::abs(above - below), 1e-8);
  EXPECT_NEAR(gradient_of(table, 0, z - 1e-7), below, 1e-6 * std::abs(above - below));
  EXPECT_NEAR(gradient_of(table, 0, z + 1e-7), above, 1e-6 * std::abs(above - below));
}

TEST(IndexTable, AnEyeAboveTheAirGetsAVacuumCell) {
  // oracle: vacuum: n = 1; without such an eye the table ends with the air
  // tolerance: exact
  const Profile &profile = reference_profile("us76");
  const IndexTable plain = build_index_table(profile, {450, 550}, {false, 1e-3, 100});
  const IndexTable high = build_index_table(profile, {450, 550}, {false, 1e-3, 400000});
  EXPECT_EQ(high.cells_per_row, plain.cells_per_row + 1);
  EXPECT_NEAR(plain.top_m(), f64::flattened_height_m(120000, plain.curvature_per_m), 1e-9);
  EXPECT_GT(high.top_m(), f64::flattened_height_m(400000, high.curvature_per_m));
  for (std::size_t row = 0; row < 2; ++row) {
    const IndexCellData &vacuum = high.cell(row, high.cells_per_row - 1);
    for (int k = 0; k < 4; ++k) {
      EXPECT_EQ(vacuum.gradient[k], 0);
      EXPECT_EQ(vacuum.density[k], 0);
    }
    EXPECT_EQ(vacuum.log_index, 0);
    for (std::size_t i = 0; i < plain.cells_per_row; ++i)
      EXPECT_EQ(high.cell(row, i).log_index, plain.cell(row, i).log_index);
  }
}

TEST(IndexTable, RowsShareTheirKnots) {
  // oracle: one set of heights for all wavelengths; a shorter wave is refracted more everywhere
  // tolerance: exact
  const IndexTable table = build_index_table(reference_profile("duct_10K"), {400, 550, 700}, {});
  for (std::size_t i = 0; i < table.cells_per_row; ++i) {
    EXPECT_EQ(table.cell(0, i).bottom_m, table.cell(2, i).bottom_m);
    EXPECT_EQ(table.cell(0, i).thickness_m, table.cell(2, i).thickness_m);
    EXPECT_GT(table.cell(0, i).log_index, table.cell(1, i).log_index);
    EXPECT_GT(table.cell(1, i).log_index, table.cell(2, i).log_index);
  }
}

TEST(IndexTable, ExaggerationIsInTheTable) {
  // oracle: 1 + 50 (n - 1) at the ground and at 8 km
  // tolerance: 1e-12 in ln n
  ProfileSpec spec;
  spec.exaggerate = 50;
  const Profile profile(spec);
  const IndexTable table = build_index_table(profile, {550}, {});
  for (double h : {0.0, 8000.0}) {
    const double expected = std::log1p(50 * reference_profile("us76").refractivity(h, 550).value);
    EXPECT_NEAR(table.log_index(0, f64::flattened_height_m(h, table.curvature_per_m)), expected, 1e-12);
  }
}

TEST(IndexTable, RefusesWhatNeedsTooManyCells) {
  // oracle: a medium rough at every scale (5 mm waves under 1 km) cannot be had in 100000 cells
  // tolerance: exact
  LayeredMedium rough;
  rough.refractivity = [](double h, double) { return Dual(1e-4, 1e-5 * std::sin(h * 1256.0)); };
  rough.density_kg_m3 = [](double) { return 0.0; };
  rough.top_m = 1000;
  IndexTableOptions fine;
  fine.error_arcsec = 1e-6;
  EXPECT_THROW((void)build_index_table(rough, {550}, fine), InputError);
}

}  // namespace
}  // namespace greenray
