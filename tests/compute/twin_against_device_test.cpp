// The same text on host and device: functions, whole rays, struct layouts, random words; every lane width and storage.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "compute/probe.hpp"
#include "render/launch.hpp"
#include "support/angle.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

/// Rays of a fan over standard air with an inversion: to space, to the ground and trapped.
struct Fan {
  IndexTable table;
  std::vector<f64::RayStart> starts;
};

const Fan &fan() {
  static const Fan made = [] {
    ProfileSpec spec;
    spec.inversions.push_back({8.0, 50.0, 5.0, {}});
    Fan f{build_index_table(Profile(spec), {450, 550, 650}, {false, 1e-3, 0}), {}};
    for (int i = 0; i < 301; ++i) {
      const double until_m = i % 5 == 4 ? 40000 : until_it_leaves;
      f.starts.push_back(launch(f.table, static_cast<std::size_t>(i % 3), 45, to_rad(-0.75 + 0.005 * i), until_m));
    }
    return f;
  }();
  return made;
}

TraceOptions options_for(Precision precision) {
  TraceOptions options;
  options.precision = precision;
  options.storage = TableStorage::buffer;
  options.tolerance_rad = precision == Precision::double_ ? 1e-12 : 1e-9;
  return options;
}

void expect_same_bits(const std::vector<f64::RayEnd> &a, const std::vector<f64::RayEnd> &b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].outcome, b[i].outcome) << i;
    EXPECT_EQ(a[i].bending_rad, b[i].bending_rad) << i;
    EXPECT_EQ(a[i].above_m, b[i].above_m) << i;
    EXPECT_EQ(a[i].rise, b[i].rise) << i;
    EXPECT_EQ(a[i].sigma_m, b[i].sigma_m) << i;
    EXPECT_EQ(a[i].optical_path_m, b[i].optical_path_m) << i;
    for (int k = 0; k < 3; ++k) EXPECT_EQ(a[i].column[k], b[i].column[k]) << i;
    EXPECT_EQ(a[i].min_z_m, b[i].min_z_m) << i;
    EXPECT_EQ(a[i].max_z_m, b[i].max_z_m) << i;
    EXPECT_EQ(a[i].steps, b[i].steps) << i;
    EXPECT_EQ(a[i].rejected, b[i].rejected) << i;
    EXPECT_EQ(a[i].turning_points, b[i].turning_points) << i;
    EXPECT_EQ(a[i].cell, b[i].cell) << i;
  }
}

template <class Twin>
class TwinAgainstDevice : public ::testing::Test {};
using Twins = ::testing::Types<Single, Double>;
TYPED_TEST_SUITE(TwinAgainstDevice, Twins);

template <class Twin>
std::vector<typename Twin::ProbeIn> random_inputs(int count) {
  using Scalar = typename Twin::Scalar;
  std::mt19937 engine(20040601);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<typename Twin::ProbeIn> inputs;
  for (int i = 0; i < count; ++i) {
    auto in = smooth_cell_ray<Twin>(400 * unit(engine), 0.2 * (unit(engine) - 0.5), 1 + 3000 * unit(engine));
    for (int k = 0; k < 4; ++k) in.cell.gradient[k] = static_cast<Scalar>(4e-7 * (unit(engine) - 0.5));
    in.cell.bottom_m = static_cast<Scalar>(90000 * unit(engine));
    in.cell.log_index = static_cast<Scalar>(3e-4 * unit(engine));
    inputs.push_back(in);
  }
  return inputs;
}

/// What the values of one probe are made of, so that cancelled sums are not held to the rounding of their difference.
template <class Twin>
std::vector<double> scales(const typename Twin::ProbeIn &in) {
  double gradient = 0, density = 0;
  for (int k = 0; k < 4; ++k) {
    gradient += std::abs(static_cast<double>(in.cell.gradient[k]));
    density += std::abs(static_cast<double>(in.cell.density[k]));
  }
  const double run = static_cast<double>(in.run), rise = std::abs(static_cast<double>(in.rise)),
               h = static_cast<double>(in.step_m), above = static_cast<double>(in.above_m);
  const double momentum2 = run * run + rise * rise, force = momentum2 * (gradient + 1 / 6371000.0);
  const double index = static_cast<double>(in.cell.log_index) + 400 * gradient;
  const double grown = 2 + h * force;  // an overshooting step may leave its cell: its polynomials grow
  std::vector<double> s{gradient, 3 * gradient, index,     density,       index + 0.02, rise,
                        force,    gradient,     momentum2, density * 1.1, 1.1,          1.1};
  for (int step = 0; step < 2; ++step)
    for (double value : {above + h * rise + h * h * force * grown, rise + h * force * grown, h * gradient * grown,
                         h * momentum2 * 1.01})
      s.push_back(value);
  s.push_back(1e9);  // sigma_to_edge: held against the edge below instead
  s.push_back(400);
  return s;
}

TYPED_TEST(TwinAgainstDevice, EveryFunctionInEveryLaneWidth) {
  // oracle: the host twin, the same text compiled as C++
  // tolerance: 8 ulp of what each sum is made of (the device may contract a b + c; its exp is good to 3 ulp; a step
  // adds
  //            some forty terms). Measured with PoCL: 2.9 in both precisions and every width
  using Twin = TypeParam;
  const double eps = std::numeric_limits<typename Twin::Scalar>::epsilon();
  const auto inputs = random_inputs<Twin>(500);
  const auto bodies = usual_absorbers<Twin>();
  for (int lanes : {1, 4, 8}) {
    const auto outputs = probe_functions(shared_device(lanes), inputs, bodies);
    ASSERT_EQ(outputs.size(), inputs.size());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      const auto expected = Twin::probe(inputs[i], bodies);
      const std::vector<double> scale = scales<Twin>(inputs[i]);
      ASSERT_EQ(scale.size(), std::size(expected.value));
      for (std::size_t k = 0; k < scale.size(); ++k) {
        const double got = static_cast<double>(outputs[i].value[k]), want = static_cast<double>(expected.value[k]);
        const double ulp = std::abs(got - want) / (eps * scale[k]);
        if (k == 10) {
          EXPECT_NEAR(got, want, 40 * eps * want + 1e-30) << "ozone, lanes " << lanes;
        }
        EXPECT_LT(ulp, 8) << "value " << k << ", input " << i << ", lanes " << lanes;
      }
      const double sigma = static_cast<double>(outputs[i].value[20]), wanted = static_cast<double>(expected.value[20]);
      EXPECT_NEAR(sigma, wanted, 2e4 * eps * std::abs(wanted)) << i;
    }
  }
}

TYPED_TEST(TwinAgainstDevice, WholeRays) {
  // oracle: the host twin, marching the same table
  // tolerance: outcome, turning points equal; bending 1e-11 rad in double, 2e-8 rad (0.004 arcsec) in float, 2e-7 rad
  // with
  //            the paper's stepping, whose many steps each round (measured 7e-13, 6e-9, 5e-8)
  using Twin = TypeParam;
  TraceOptions options = options_for(Twin::precision);
  for (Integrator integrator : {Integrator::dormand_prince, Integrator::richardson}) {
    options.integrator = integrator;
    options.tolerance_rad = Twin::is_double ? 1e-11 : 1e-9;
    const auto device = RayTracer(shared_device(), fan().table, options).trace(fan().starts);
    const auto compare = [&](const auto &twin) {
      double worst = 0;
      ASSERT_EQ(twin.size(), device.size());
      for (std::size_t i = 0; i < twin.size(); ++i) {
        EXPECT_EQ(twin[i].outcome, device[i].outcome) << i;
        EXPECT_EQ(twin[i].turning_points, device[i].turning_points) << i;
        if (twin[i].outcome == f64::RAY_TRAPPED) continue;  // ends somewhere beyond its second turn
        worst = std::max(worst, std::abs(static_cast<double>(twin[i].bending_rad) - device[i].bending_rad));
        EXPECT_NEAR(twin[i].optical_path_m, device[i].optical_path_m,
                    (Twin::is_double ? 1e-7 : 2e-5) * device[i].optical_path_m);
        EXPECT_NEAR(twin[i].column[0], device[i].column[0], (Twin::is_double ? 1e-7 : 2e-5) * device[i].column[0]);
      }
      EXPECT_LT(worst, Twin::is_double ? 1e-11 : integrator == Integrator::richardson ? 2e-7 : 2e-8);
    };
    if constexpr (Twin::is_double) {
      if (integrator == Integrator::richardson) compare(trace_on_twin<DoublePaper>(fan().table, fan().starts, options));
      else compare(trace_on_twin<Double>(fan().table, fan().starts, options));
    } else {
      if (integrator == Integrator::richardson) compare(trace_on_twin<SinglePaper>(fan().table, fan().starts, options));
      else compare(trace_on_twin<Single>(fan().table, fan().starts, options));
    }
  }
}

TYPED_TEST(TwinAgainstDevice, LayoutsAgree) {
  // oracle: sizeof and offsetof of the host compiler
  // tolerance: exact
  for (int lanes : {1, 4, 8})
    EXPECT_EQ(device_layout(shared_device(lanes), TypeParam::is_double), host_layout(TypeParam::is_double));
}

TYPED_TEST(TwinAgainstDevice, LaneWidthsAgreeWithinRounding) {
  // oracle: one lane, no selects
  // tolerance: the compiler may contract differently per width: bending 2e-11 rad in double, 2e-8 rad in float.
  // Measured with
  //            PoCL: all 257 rays the same bits, for 4 and 8 against 1
  const TraceOptions options = options_for(TypeParam::precision);
  const auto one = RayTracer(shared_device(1), fan().table, options).trace(fan().starts);
  for (int lanes : {4, 8}) {
    const auto many = RayTracer(shared_device(lanes), fan().table, options).trace(fan().starts);
    double worst = 0;
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(one[i].outcome, many[i].outcome) << i;
      if (one[i].outcome == f64::RAY_TRAPPED) continue;
      worst = std::max(worst, std::abs(one[i].bending_rad - many[i].bending_rad));
    }
    EXPECT_LT(worst, TypeParam::is_double ? 2e-11 : 2e-8);
  }
}

TYPED_TEST(TwinAgainstDevice, LocalSizeAndBatchesChangeNoBit) {
  // oracle: the same rays in one batch with local size 1
  // tolerance: exact
  for (int lanes : {1, 8}) {
    TraceOptions options = options_for(TypeParam::precision);
    options.local_size = 1;
    const auto expected = RayTracer(shared_device(lanes), fan().table, options).trace(fan().starts);
    for (int local_size : {2, 16}) {
      options.local_size = local_size;
      expect_same_bits(RayTracer(shared_device(lanes), fan().table, options).trace(fan().starts), expected);
    }
    options.local_size = 0;
    // Split by hand at places that shift rays to other lanes, through one tracer.
    RayTracer tracer(shared_device(lanes), fan().table, options);
    std::vector<f64::RayEnd> parts;
    const std::span<const f64::RayStart> all(fan().starts);
    for (std::size_t first = 0, size = 1; first < all.size(); first += size, size = size * 2 + 1)
      for (const f64::RayEnd &end : tracer.trace(all.subspan(first, std::min(size, all.size() - first))))
        parts.push_back(end);
    expect_same_bits(parts, expected);
    EXPECT_EQ(tracer.stats().rays, all.size());
  }
}

TYPED_TEST(TwinAgainstDevice, ASmallMemoryBudgetChangesNoBit) {
  // oracle: the same rays with the whole memory; the budget leaves room for some 64 rays beside the table
  // tolerance: exact
  const TraceOptions options = options_for(TypeParam::precision);
  const auto expected = RayTracer(shared_device(), fan().table, options).trace(fan().starts);
  DeviceOptions small = device_options();
  small.memory_bytes = fan().table.cells.size() * sizeof(IndexCellData) + 30000;
  RayTracer tracer(open_device(small), fan().table, options);
  expect_same_bits(tracer.trace(fan().starts), expected);
  EXPECT_EQ(tracer.device().used_bytes(), fan().table.cells.size() * sizeof(IndexCellData));
}

TEST(Storage, ImageAndBufferGiveTheSameBits) {
  // oracle: the table read from a buffer
  // tolerance: exact: NEAREST reads are copies
  if (!shared_device()->info().has_images) GTEST_SKIP() << "no images on this device";
  for (int lanes : {1, 4, 8}) {
    TraceOptions options = options_for(Precision::single_);
    const auto from_buffer = RayTracer(shared_device(lanes), fan().table, options).trace(fan().starts);
    options.storage = TableStorage::image;
    RayTracer tracer(shared_device(lanes), fan().table, options);
    expect_same_bits(tracer.trace(fan().starts), from_buffer);
    EXPECT_TRUE(tracer.uses_image());
  }
}

TEST(Storage, MeasuredChoosesOneAndKeepsTheBits) {
  // oracle: the table read from a buffer
  // tolerance: exact
  std::vector<f64::RayStart> many;
  for (int i = 0; i < 4100; ++i) many.push_back(fan().starts[static_cast<std::size_t>(i) % fan().starts.size()]);
  TraceOptions options = options_for(Precision::single_);
  const auto from_buffer = RayTracer(shared_device(), fan().table, options).trace(many);
  options.storage = TableStorage::measured;
  expect_same_bits(RayTracer(shared_device(), fan().table, options).trace(many), from_buffer);
}

TEST(Storage, DoubleHasNoImage) {
  // oracle: images hold floats: asking for one in double is refused with a reason
  // tolerance: exact
  TraceOptions options = options_for(Precision::double_);
  options.storage = TableStorage::image;
  EXPECT_THROW(RayTracer(shared_device(), fan().table, options), RunError);
}

TEST(Random, DeviceGivesThePublishedWords) {
  // oracle: kat_vectors of Random123 for philox4x32 with 10 rounds; the host twin for 1000 more
  // tolerance: exact
  std::vector<std::array<std::uint32_t, 6>> rows{
      {0, 0, 0, 0, 0, 0},
      {0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff},
      {0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344, 0xa4093822, 0x299f31d0}};
  std::mt19937 engine(7);
  for (int i = 0; i < 1000; ++i) {
    auto &row = rows.emplace_back();
    for (auto &word : row) word = static_cast<std::uint32_t>(engine());
  }
  const auto words = random_words(shared_device(), rows);
  using Words = std::array<std::uint32_t, 4>;
  EXPECT_EQ(words[0], (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(words[1], (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(words[2], (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto &r = rows[i];
    const f32::RandomWords twin = f32::philox({{r[0], r[1], r[2], r[3]}}, r[4], r[5]);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(words[i][k], twin.word[k]);
  }
}

}  // namespace
}  // namespace greenray
